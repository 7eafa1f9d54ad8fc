"""What the documents say of engines and profiles is what the adapters say."""

from __future__ import annotations

import pytest

from bench.machine.source_digest import ROOT
from bench.publishing.doc_blocks import BLOCKS, filled


@pytest.mark.parametrize("block", BLOCKS)
def test_a_document_holds_what_the_adapters_declare(block: str) -> None:
    name, write = BLOCKS[block]
    document = (ROOT / name).read_text(encoding="utf-8")
    assert document == filled(document, name, block, write()), (
        "fill it anew: uv run python -m bench.publishing.doc_blocks"
    )


def test_only_what_is_between_the_marks_is_replaced() -> None:
    document = "before\n<!-- begin one (how) -->\nold\n<!-- end one -->\nafter\n"
    assert (
        filled(document, "a.md", "one", "new\n")
        == "before\n<!-- begin one (how) -->\n\nnew\n\n<!-- end one -->\nafter\n"
    )
    with pytest.raises(ValueError, match=r"a\.md: block 'two' is missing: mark its place with .* run"):
        filled(document, "a.md", "two", "new")
