"""Read and parse untrusted JSON; reject NaN, Infinity, duplicate keys, and files larger than ``MOST_BYTES``."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, NoReturn

MOST_BYTES = 2**26
"""Greatest size of a file [bytes]: 64 MiB, because a file of about 40,000 trials has this size."""


class JsonError(ValueError):
    """A file with unacceptable JSON; the message names the reason and the fix."""


def read_file(path: Path) -> bytes:
    """Return the content of a file that is no larger than ``MOST_BYTES``.

    Raises:
        JsonError: if the file is unreadable or larger.
    """
    try:
        with path.open("rb") as file:
            content = file.read(
                MOST_BYTES + 1
            )  # the size on disk is no substitute, because a pipe or a device has none
    except OSError as error:
        raise JsonError(
            f"{path}: cannot read this file ({error.strerror}); name a readable file or a results folder"
        ) from error
    if len(content) > MOST_BYTES:
        raise JsonError(
            f"{path}: the file must have at most {MOST_BYTES >> 20} MiB, but is larger; name a file of "
            "'bench baseline', 'bench run' or pytest-benchmark"
        )
    return content


def parse(content: bytes, source: str) -> Any:
    """Return the value of the JSON text ``content``.

    Args:
        content: a text in UTF-8.
        source: name of the file, for error messages.

    Raises:
        JsonError: if ``content`` is not JSON in UTF-8, nests too deeply, or contains NaN, Infinity or a duplicate key.
    """
    try:
        return json.loads(content.decode("utf-8"), object_pairs_hook=_without_twins, parse_constant=_refuse)
    except UnicodeDecodeError as error:
        raise JsonError(f"{source}: not a text in UTF-8 (byte {error.start}); create the file again") from error
    except json.JSONDecodeError as error:
        raise JsonError(f"{source}: not valid JSON, or cut off: {error}; create the file again") from error
    except RecursionError:
        raise JsonError(f"{source}: the JSON text nests too deeply; create the file again") from None
    except ValueError as error:  # also raised for an integer of thousands of digits
        raise JsonError(f"{source}: {error}; correct this entry, or create the file again") from error


def _without_twins(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    table = dict(pairs)
    if len(table) < len(pairs):
        seen: set[str] = set()
        twin = next(key for key, _ in pairs if key in seen or seen.add(key))  # type: ignore[func-returns-value]
        raise ValueError(f"key {twin[:80]!r} must occur once in an object, but occurs again: remove the repetition")
    return table


def _refuse(constant: str) -> NoReturn:
    raise ValueError(f"every number must be finite, got {constant}: give a finite number")
