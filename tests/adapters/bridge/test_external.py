"""Engines outside the repository are found, and the message about a mistake in their file names the fix."""

import os
from pathlib import Path

import pytest

from adapters import ENGINES, EnginesFileError, register_external
from adapters.bridge.external import ExternalEntry, read_engines


@pytest.fixture(autouse=True)
def engines(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in list(ENGINES):  # whatever a test adds is taken out again
        monkeypatch.setitem(ENGINES, name, ENGINES[name])


def written(folder: Path, text: str) -> Path:
    path = folder / "engines.toml"
    path.write_text(text)
    return path


def test_a_file_in_the_working_directory_is_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    written(tmp_path, "[mine]\ncommand = ['./mine', '--quiet']\nprofiles = 'mine.toml'\ntimeout_s = 5\n")
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("STILLSTACK_ENGINES", raising=False)
    monkeypatch.setitem(ENGINES, "mine", ENGINES["bullet"])
    register_external()
    assert ENGINES["mine"] == ExternalEntry(
        "mine", ("./mine", "--quiet"), tmp_path, tmp_path / "mine.toml", 5.0, "engines.toml: [mine]"
    )


def test_an_entry_point_names_the_class_of_a_package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    info = tmp_path / "my_package-1.2.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: my-package\nVersion: 1.2\n")
    (info / "entry_points.txt").write_text("[stillstack.engines]\nmine = my_package.adapter:MySimulation\n")
    (tmp_path / "my_package").mkdir()
    (tmp_path / "my_package" / "__init__.py").touch()
    (tmp_path / "my_package" / "adapter.py").write_text("class MySimulation: ...\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.setitem(ENGINES, "mine", ENGINES["bullet"])
    register_external()
    assert ENGINES["mine"].version() == "1.2"
    assert ENGINES["mine"].load().__name__ == "MySimulation"


def test_a_file_that_the_environment_names_must_be_there(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(os.environ, "STILLSTACK_ENGINES", "/nowhere/engines.toml")
    with pytest.raises(EnginesFileError, match=r"/nowhere/engines.toml: cannot read this file .* STILLSTACK_ENGINES"):
        register_external()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[mine\n", "not valid TOML"),
        ("mine = 3\n", "'mine' must be a table"),
        (
            "[mine]\n",
            r"'command' must be a list of texts, at least the program, such as \['program', 'argument'\], got None",
        ),
        ("[mine]\ncommand = 'node mine.mjs'\n", "'command' must be a list of texts"),
        (
            "[mine]\ncommand = ['a']\nprofile = 'b'\n",
            "unknown key 'profile'; use one of command, profiles or timeout_s",
        ),
        ("[mine]\ncommand = ['a']\nprofiles = 3\n", "'profiles' must be the name of a file"),
        (
            "[mine]\ncommand = ['a']\ntimeout_s = 0\n",
            "'timeout_s' must be a finite time in seconds",
        ),
    ],
)
def test_a_mistake_is_reported(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(EnginesFileError, match=message):
        read_engines(written(tmp_path, text))


def test_the_name_of_an_engine_of_the_suite_is_taken(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = written(tmp_path, "[bullet]\ncommand = ['a']\n")
    monkeypatch.setitem(os.environ, "STILLSTACK_ENGINES", str(path))
    with pytest.raises(EnginesFileError, match=r"the name 'bullet' must be new, .* give your engine another name"):
        register_external()


def test_a_program_that_is_not_there_is_reported_with_its_entry(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = written(tmp_path, "[mine]\ncommand = ['no-such-program']\n")
    monkeypatch.setitem(os.environ, "STILLSTACK_ENGINES", str(path))
    monkeypatch.setitem(ENGINES, "mine", ENGINES["bullet"])
    register_external()
    from adapters import capabilities

    with pytest.raises(
        ImportError,
        match=r"'no-such-program' must be an executable program in .*its command runs: \['no-such-program'\], from",
    ):
        capabilities("mine")
