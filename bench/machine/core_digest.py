"""A digest of the core's code without prose, to identify the core of a published page.

The digest covers the syntax trees of all Python files of ``stability_core`` except its ports to engines, sorted by
name. The digest leaves out the ports, because a port only passes data between engine and core. The digest ignores
docstrings, other stand-alone strings, comments, layout and the wording of messages, so that an edit of prose does not
change the digest. A string with a space counts as a message; keys and names have no spaces. Any other edit changes the
digest, even an edit without effect on results, such as a renamed variable.
"""

from __future__ import annotations

import ast
import hashlib
import io
import subprocess
import tarfile
from collections.abc import Mapping

from bench.machine.source_digest import PORTS, ROOT

CORE = "stability_core"
"""Name of the folder of the core."""


def digest_of(sources: Mapping[str, str]) -> str:
    """Return the digest of ``sources``, the source texts by file name, as 12 hexadecimal digits.

    The names are relative to the folder of the core. The function ignores the files of the ports.
    """
    digest = hashlib.blake2b(digest_size=6)
    for name in sorted(name for name in sources if not name.startswith(f"{PORTS}/")):
        digest.update(f"{name}\0{_code(ast.parse(sources[name]))}\0".encode())
    return digest.hexdigest()


def present_core() -> str:
    """Return the digest of the core of this checkout."""
    folder = ROOT / CORE
    return digest_of(
        {path.relative_to(folder).as_posix(): path.read_text(encoding="utf-8") for path in folder.rglob("*.py")}
    )


def core_of_commit(commit: str) -> str | None:
    """Return the digest of the core in a commit; None without git, or if the repository does not have the commit."""
    try:
        archive = subprocess.run(
            ["git", "archive", commit, CORE], cwd=ROOT, capture_output=True, check=True, timeout=60
        ).stdout
    except (OSError, subprocess.SubprocessError):
        return None
    with tarfile.open(fileobj=io.BytesIO(archive)) as files:
        sources = {
            member.name.removeprefix(f"{CORE}/"): file.read().decode()
            for member in files
            if member.name.endswith(".py") and (file := files.extractfile(member)) is not None
        }
    return digest_of(sources)


def _code(part: object) -> str:
    """Return a syntax tree as text, without prose.

    The text omits empty fields, because these fields differ between versions of Python.
    """
    if _is_message(part):
        return "message"
    if isinstance(part, ast.AST):
        fields = [f"{name}={_code(value)}" for name, value in ast.iter_fields(part) if value not in (None, [])]
        return f"{type(part).__name__}({', '.join(fields)})"
    if isinstance(part, list):
        return f"[{', '.join(_code(item) for item in part if not _is_prose(item))}]"
    return repr(part)


def _is_prose(statement: object) -> bool:
    """Return whether a statement is only a string: a docstring, or the description below a constant."""
    if not isinstance(statement, ast.Expr) or not isinstance(statement.value, ast.Constant):
        return False
    return isinstance(statement.value.value, str)


def _is_message(expression: object) -> bool:
    """Return whether an expression is a text for people: a string with a space, formatted or not."""
    if isinstance(expression, ast.JoinedStr):
        return any(_is_message(piece) for piece in expression.values)
    return isinstance(expression, ast.Constant) and isinstance(expression.value, str) and " " in expression.value
