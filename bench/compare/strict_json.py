"""Parse untrusted JSON: refuse it, with the reason, unless it is finite, unambiguous and of limited size."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, NoReturn

MOST_BYTES = 2**26
"""Greatest size of a file [bytes]: 64 MiB hold some 40,000 trials."""


class JsonError(ValueError):
    """A text that is not acceptable JSON; the message states the reason."""


def read_file(path: Path) -> bytes:
    """Return the content of a file that is no larger than ``MOST_BYTES``.

    Raises:
        JsonError: if it cannot be read or is larger.
    """
    try:
        with path.open("rb") as file:
            content = file.read(MOST_BYTES + 1)  # the size on disk is no guide: a pipe or a device has none
    except OSError as error:
        raise JsonError(f"{path}: cannot be read ({error.strerror})") from error
    if len(content) > MOST_BYTES:
        raise JsonError(f"{path}: larger than {MOST_BYTES >> 20} MiB, which no results of this suite are")
    return content


def parse(content: bytes, source: str) -> Any:
    """Return the value of ``content``; ``source`` names it in errors.

    Raises:
        JsonError: if it is not JSON in UTF-8, nests too deeply, or holds NaN, infinity or a key twice.
    """
    try:
        return json.loads(content.decode("utf-8"), object_pairs_hook=_without_twins, parse_constant=_refuse)
    except UnicodeDecodeError as error:
        raise JsonError(f"{source}: not a text in UTF-8") from error
    except json.JSONDecodeError as error:
        raise JsonError(f"{source}: not valid JSON, or cut off: {error}") from error
    except RecursionError:
        raise JsonError(f"{source}: nests too deeply") from None
    except ValueError as error:  # also for an integer of thousands of digits
        raise JsonError(f"{source}: {error}") from error


def _without_twins(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    table = dict(pairs)
    if len(table) < len(pairs):
        seen: set[str] = set()
        twin = next(key for key, _ in pairs if key in seen or seen.add(key))  # type: ignore[func-returns-value]
        raise ValueError(f"key {twin[:80]!r} stands twice in one object")
    return table


def _refuse(constant: str) -> NoReturn:
    raise ValueError(f"holds {constant}, which is no number")
