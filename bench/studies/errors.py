"""Error messages for the fields of a study, in the terms of the study's author."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Any

_PLAIN: Mapping[str, Callable[[Mapping[str, Any]], str]] = {
    "missing": lambda _: "is missing; add this field",
    "greater_than": lambda limits: f"must be above {limits['gt']:g}",
    "greater_than_equal": lambda limits: f"must be {limits['ge']} or more",
    "less_than_equal": lambda limits: f"must be {limits['le']} or less",
    "int_type": lambda _: "must be a whole number",
    "int_parsing": lambda _: "must be a whole number, without quotes",
    "int_from_float": lambda _: "must be a whole number",
    "float_type": lambda _: "must be a number",
    "float_parsing": lambda _: "must be a number, without quotes",
    "finite_number": lambda _: "must be a finite number",
    "bool_type": lambda _: "must be true or false",
    "bool_parsing": lambda _: "must be true or false",
    "string_type": lambda _: "must be a text in quotes",
    "string_pattern_mismatch": lambda _: (
        "must be letters, digits, '-' and '_', with a letter or a digit first, because the text names a folder"
    ),
    "list_type": lambda _: "must be a list in brackets",
    "too_short": lambda _: "must not be empty",
    "dict_type": lambda _: "must be a table",
    "model_type": lambda _: "must be a table",
}
"""Functions that return the plain message, by the error type of pydantic; errors of other types keep pydantic's
message."""


def field_name(location: Iterable[str | int]) -> str:
    """Return the location of a field in the notation of a study's author, such as ``scenario[0].name``."""
    parts = [part for part in location if isinstance(part, int) or not part.startswith(("list[", "function-"))]
    return "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in parts).lstrip(".")


def plain_words(detail: Mapping[str, Any]) -> str:
    """Return the plain message for an error detail of pydantic."""
    if detail["type"] == "value_error":  # the message of a validator of this suite
        return str(detail["msg"]).removeprefix("Value error, ")
    words = _PLAIN.get(detail["type"])
    said = words(detail.get("ctx", {})) if words else str(detail["msg"])
    return said if detail["type"] == "missing" else f"{said}, got {detail['input']!r:.80}: correct this value"
