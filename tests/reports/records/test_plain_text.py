"""Terminal escapes of engines vanish; words stay."""

import pytest

from reports.records.plain_text import plain_text
from reports.records.trial import TrialRecord
from tests.reports.studies import record


@pytest.mark.parametrize(
    ("text", "plain"),
    [
        ("out of contacts", "out of contacts"),
        ("\x1b[31mred\x1b[0m and \x1b[1;38;5;208mbold\x1b[m", "red and bold"),
        ("\x1b[2K\x1b[1Gline", "line"),
        ("\x1b[?25lhidden\x1b[?25h", "hidden"),
        ("\x1b]0;title\x07text", "text"),
        ("\x1b]8;;http://x\x1b\\link\x1b]8;;\x1b\\", "link"),
        ("\x9b31mred", "red"),
        ("\x1b(Bplain\x1bc", "plain"),
        ("cut off \x1b[3", "cut off "),
        ("cut off \x1b", "cut off "),
        ("cut \x1b]0;title\nnext line", "cut \nnext line"),
        ("[31m is no escape", "[31m is no escape"),
        ("bell\x07 and nul\x00", "bell\N{REPLACEMENT CHARACTER} and nul\N{REPLACEMENT CHARACTER}"),
        ("tab\tand\nlines: µ, 石", "tab\tand\nlines: µ, 石"),
        ("one\r\ntwo\rthree", "one\ntwo\nthree"),
        ("no text \udcff", "no text \N{REPLACEMENT CHARACTER}"),
    ],
)
def test_escapes_vanish_and_words_stay(text: str, plain: str) -> None:
    assert plain_text(text) == plain


@pytest.mark.parametrize("field", ["message", "frame_ratio_message"])
def test_no_record_holds_an_escape_also_if_a_file_does(field: str) -> None:
    fields = record().model_dump() | {field: "\x1b[31mRuntimeError\x1b[0m: \udc80"}
    made = TrialRecord(**fields)
    assert getattr(made, field) == "RuntimeError: \N{REPLACEMENT CHARACTER}"
    line = made.model_dump_json().replace("RuntimeError", r"\u001b[32mRuntimeError")
    assert getattr(TrialRecord.model_validate_json(line), field).startswith("RuntimeError")
