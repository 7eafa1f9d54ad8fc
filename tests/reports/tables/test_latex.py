"""The comparison as LaTeX: numbers as siunitx reads them, and text that LaTeX does not take for commands."""

import re
import shutil
import subprocess

import pytest

from reports.statistics.groups import groups_of
from reports.statistics.pairs import pair_rows, paired_scenes
from reports.tables.comparison import comparison_rows
from reports.tables.latex import escape, pairs_to_latex, table_to_latex, to_latex, with_uncertainty
from reports.tables.pairs import pair_tables
from reports.tables.study import study_tables
from tests.reports.studies import FALLS, STANDS, failed, fallen, record

PAIRED = [(0, 0), (1, 0), (2, 0), (2, 1), (2, 2)]


def ratio(number: int) -> dict[str, float]:
    return {"frame_ratio": 0.1 * (number + 1), "frame_ratio_level": 5}


RECORDS = [
    *(fallen(4 + seed, seed=seed) for seed in range(3)),
    *(record(policy="at_rest", seed=seed, repeat=repeat, **ratio(seed + repeat)) for seed, repeat in PAIRED),
    failed("unsupported", engine="pymunk"),
]


CAPTION = "n = 7 trials of 100 % & more."
PAIRS = [
    record(scene=f"table_2-{side}", pair="table_2", expectation=theory, verdict=verdict, seed=seed)
    for seed, fall in enumerate(["right", "right", "false_stand"])
    for side, theory, verdict in (("stand", STANDS, "right"), ("fall", FALLS, fall))
]


def table() -> str:
    return to_latex(comparison_rows(groups_of(RECORDS)), CAPTION, "made_up")


def pairs() -> str:
    return pairs_to_latex(pair_rows(groups_of(PAIRS)), CAPTION, "made_up")


@pytest.mark.parametrize(
    ("value", "uncertainty", "text"),
    [(1.2341, 0.0119, "1.234(12)"), (1.2, None, "1.200"), (10.0, 1.5, "10.000(1500)"), (1.0, 0.0, "1.000(0)")],
)
def test_an_uncertainty_is_in_units_of_the_last_digit(value, uncertainty, text) -> None:
    assert with_uncertainty(value, uncertainty) == text


def test_a_row_has_its_medians_deviations_and_bounds() -> None:
    rows = [line.rstrip(" \\") for line in table().splitlines() if line.startswith("four")]
    cells = [row.split(" & ") for row in rows]
    # medians of 1.0, 1.1, 1.2 and of 4, 5, 6; none of those completed has a level of collapse
    assert cells[0][:5] == [r"four\_stack", "bullet", "game", "none", "3"]
    assert cells[0][5].startswith("5 [4")
    assert cells[0][7] == "1.100(100)"
    assert cells[1][5] == r"none fell, $\geq$30"
    assert cells[1][9] == "0.30 [0.10, 0.50]"
    assert cells[2][7] == "{--}"
    assert {len(row) for row in cells} == {10}


def test_pairs_stand_under_who_built_them_with_their_interval() -> None:
    rows = [line.rstrip(" \\").split(" & ") for line in pairs().splitlines() if line.startswith(r"\quad")]
    assert [row[0] for row in rows] == [r"\quad none", r"\quad table\_2"], "all together, then by family"
    for row in rows:
        # of three builds two were right; a draw of three of them has any number from none to all
        assert row[1:] == ["3", "67 [0, 100]", "33 [0, 100]", "0", "0", "0", "0"]
    assert r"\multicolumn{8}{@{}l}{bullet, game, none}" in pairs()


def test_caption_and_label_are_escaped() -> None:
    assert r"n = 7 trials of 100 \% \& more." in table()
    assert r"\label{tab:made-up}" in table()
    assert escape("a_b^c") == r"a\_b\textasciicircum{}c"


def test_braces_and_environments_are_balanced() -> None:
    for text in (table(), pairs()):
        output = re.sub(r"\\[{}]", "", text)
        assert output.count("{") == output.count("}")
        assert re.findall(r"\\begin\{(\w+)\}", output) == re.findall(r"\\end\{(\w+)\}", output)


def tables() -> str:
    """Every table of a study."""
    groups = groups_of(PAIRS)
    return "".join(
        map(table_to_latex, [*study_tables(RECORDS), *pair_tables(pair_rows(groups), paired_scenes(groups))])
    )


def test_any_table_is_a_longtable_of_its_entries() -> None:
    text = tables()
    assert re.findall(r"\\label\{tab:([\w-]+)\}", text) == [
        "outcomes", "correctness", "frame-time", "stability", "pairs", "pairs-by-family"
    ]  # fmt: skip
    assert r"four\_stack & stands & bullet & 4 (3-5)/30 $\times$ 0/3 & 30/30 $\checkmark$ 5/5 \\" in text
    assert text.isascii()
    for name in ("toprule", "midrule", "bottomrule"):
        assert name in text


def test_latex_takes_any_table(tmp_path) -> None:
    if shutil.which("pdflatex") is None:
        pytest.skip("no LaTeX is installed: apt-get install texlive-latex-recommended")
    packages = r"\usepackage{booktabs,longtable,amssymb}"
    content = rf"\documentclass{{article}}{packages}\begin{{document}}\tiny {tables()}\end{{document}}"
    (tmp_path / "a.tex").write_text(content, encoding="utf-8")
    command = ["pdflatex", "-halt-on-error", "a.tex"]
    subprocess.run(command, cwd=tmp_path, check=True, timeout=600, capture_output=True)


def test_latex_takes_it(tmp_path) -> None:
    if shutil.which("pdflatex") is None:
        pytest.skip("no LaTeX is installed: apt-get install texlive-latex-recommended texlive-science")
    packages = r"\usepackage[margin=2cm]{geometry}\usepackage{booktabs,longtable,siunitx}"
    content = rf"\documentclass{{article}}{packages}\begin{{document}}{table()}{pairs()}\end{{document}}"
    (tmp_path / "a.tex").write_text(content, encoding="utf-8")
    command = ["pdflatex", "-halt-on-error", "a.tex"]
    for _ in range(2):  # longtable finds its widths in the second
        done = subprocess.run(command, cwd=tmp_path, check=True, timeout=600, capture_output=True, text=True)
    assert "Overfull" not in done.stdout, "a page of A4 or letter paper is wide enough"
