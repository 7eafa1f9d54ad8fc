"""The CI examples are valid for their services, and name only commands and options that the suite has."""

import json
import re
import shlex
import subprocess
from pathlib import Path

import check_jsonschema
import jsonschema
import pytest
import typer
import yaml

from bench.cli.app import app
from bench.studies.schema import study_names

ROOT = Path(__file__).parents[1]
EXAMPLES = ROOT / "docs" / "examples" / "ci"
SCHEMAS = Path(check_jsonschema.__file__).parent / "builtin_schemas" / "vendor"
WORKFLOWS = [EXAMPLES / "github_pull_request.yml", EXAMPLES / "github_nightly.yml", ROOT / ".github/workflows/ci.yml"]
VALID = {
    "github-actions": [ROOT / "action.yml"],
    "github-workflows": WORKFLOWS,
    "gitlab-ci": [EXAMPLES / "gitlab.yml"],
}
WITH_COMMANDS = [ROOT / "action.yml", ROOT / ".ci/run", ROOT / "docs/ci.md", *sorted(EXAMPLES.iterdir())]
COMMAND = re.compile(r"-m bench ((?:[^\n`]|(?<=\\)\n)+)")
ENDS = re.compile(r"\s(?:\|\||&&|;|\||>)|'$|  +\w|\)$")
"""What ends a command: an operator of the shell, the quote around a whole script, or a remark after two spaces."""


SHELL = re.compile(r"\$\(.*?\)|\$\{\w+:\+(.*?)\}|\"\$\{\w+\[@\]\}\"")
"""What the shell replaces: the output of a command, an option that may be left out (kept here), an array of options."""


def loaded(path: Path) -> dict:
    """A YAML file, in which the key ``on`` of a workflow is a text and not the truth value of YAML 1.1."""
    content = yaml.safe_load(path.read_text(encoding="utf-8"))
    return {"on" if key is True else key: value for key, value in content.items()}


@pytest.mark.parametrize(("schema", "path"), [(name, path) for name, paths in VALID.items() for path in paths])
def test_a_file_is_valid_for_its_service(schema, path) -> None:
    checker = jsonschema.validators.validator_for(rules := json.loads((SCHEMAS / f"{schema}.json").read_text("utf-8")))
    assert [error.message for error in checker(rules).iter_errors(loaded(path))] == []


def commands(path: Path) -> list[list[str]]:
    """The words after ``-m bench`` of every command in a file."""
    text = path.read_text(encoding="utf-8").replace("\\\n", " ")
    if path.suffix in (".yml", ".yaml"):
        text = re.sub(r"\n\s+(--\w)", r" \1", text)  # a folded line of a plain YAML scalar
    found = (ENDS.split(match[1].rstrip())[0] for match in COMMAND.finditer(text))
    return [shlex.split(SHELL.sub(r"\1", line)) for line in found]


@pytest.mark.parametrize("path", [path for path in WITH_COMMANDS if "-m bench" in path.read_text(encoding="utf-8")])
def test_every_command_has_the_options_and_arguments_that_it_is_given(path) -> None:
    cli = typer.main.get_command(app)
    for verb, *words in commands(path):
        assert verb in cli.commands, (verb, words)
        command = cli.commands[verb]
        context = command.context_class(command, info_name=verb)
        options, left, _ = command.make_parser(context).parse_args(list(words))
        assert not left, (verb, words)
        needed = [one.name for one in command.params if one.required and options.get(one.name) is None]
        assert not needed, (verb, words)
        if verb == "run" and not any(letter in str(options["study"]) for letter in "$/."):
            assert options["study"] in study_names()


def test_an_option_that_does_not_exist_is_found(tmp_path) -> None:
    """And so is one on a folded line of a GitLab script."""
    example = tmp_path / "x.yml"
    example.write_text("script:\n  - uv run -m bench compare a b --fail-on time\n    --no-such-option x || status=$?\n")
    with pytest.raises(Exception, match=r"(?i)no such option"):
        test_every_command_has_the_options_and_arguments_that_it_is_given(example)


def test_an_example_uses_inputs_and_outputs_that_the_action_has() -> None:
    action = loaded(ROOT / "action.yml")
    for path in WORKFLOWS:
        for job in loaded(path)["jobs"].values():
            uses = [step for step in job["steps"] if step.get("uses", "").split("@")[0] in ("OWNER/stillstack", "./")]
            assert all(set(step["with"]) <= set(action["inputs"]) for step in uses)
        outputs = set(re.findall(r"steps\.stacking\.outputs\.(\w+)", path.read_text(encoding="utf-8")))
        assert outputs <= set(action["outputs"])


def scripts(path: Path) -> list[str]:
    """The shell scripts in an example."""
    if path.suffix == ".sh":
        return [path.read_text(encoding="utf-8")]
    jobs = loaded(path)
    steps = [step for job in jobs.get("jobs", {}).values() for step in job["steps"]]
    parts = [job.get(key, []) for job in jobs.values() if isinstance(job, dict) for key in ("before_script", "script")]
    return [step["run"] for step in steps if "run" in step] + ["\n".join(lines) for lines in parts]


@pytest.mark.parametrize("path", sorted(EXAMPLES.iterdir()))
def test_every_script_is_sound_bash(path) -> None:
    for script in scripts(path):
        subprocess.run(["bash", "-n"], input=re.sub(r"\$\{\{.*?\}\}", "0", script).encode(), check=True)
