"""Tables in the terminal."""

from rich.console import Console

from reports.tables.table import Table, render


def test_brackets_of_units_are_no_markup():
    console = Console(width=80, record=True)
    render(Table("creep [um]", ("engine", "p50 [ms]"), (("bullet", "0.1"),), id="t"), console)
    text = console.export_text()
    assert "creep [um]" in text
    assert "p50 [ms]" in text
