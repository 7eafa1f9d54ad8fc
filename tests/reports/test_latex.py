"""The comparison as LaTeX: numbers as siunitx reads them, and text that LaTeX does not take for commands."""

import re
import shutil
import subprocess

import pytest

from reports.cells import cells_of
from reports.latex import escape, to_latex, with_uncertainty
from reports.matrix import matrix
from tests.reports.studies import failed, fallen, record

RECORDS = [
    *(fallen(4 + seed, seed=seed) for seed in range(3)),
    *(record(policy="at_rest", seed=seed, frame_ratio=0.1 * (seed + 1)) for seed in range(3)),
    failed("unsupported", engine="pymunk"),
]


def table() -> str:
    return to_latex(matrix(cells_of(RECORDS)), "n = 7 trials of 100 % & more.", "made_up")


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
    assert cells[1][9] == "0.20 [0.10, 0.30]"
    assert cells[2][7] == "{--}"
    assert {len(row) for row in cells} == {10}


def test_caption_and_label_are_escaped() -> None:
    assert r"n = 7 trials of 100 \% \& more." in table()
    assert r"\label{tab:made-up}" in table()
    assert escape("a_b^c") == r"a\_b\textasciicircum{}c"


def test_braces_and_environments_are_balanced() -> None:
    told = re.sub(r"\\[{}]", "", table())
    assert told.count("{") == told.count("}")
    assert re.findall(r"\\begin\{(\w+)\}", told) == re.findall(r"\\end\{(\w+)\}", told)


def test_latex_takes_it(tmp_path) -> None:
    if shutil.which("pdflatex") is None:
        pytest.skip("no LaTeX is installed: apt-get install texlive-science")
    packages = r"\usepackage{booktabs,longtable,siunitx}"
    (tmp_path / "a.tex").write_text(rf"\documentclass{{article}}{packages}\begin{{document}}{table()}\end{{document}}")
    subprocess.run(["pdflatex", "-halt-on-error", "a.tex"], cwd=tmp_path, check=True, timeout=600)
