"""Plays the shell steps of a composite GitHub action on this machine, as a runner would; passes over all others."""

from __future__ import annotations

import os
import re
import subprocess
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import yaml

_EXPRESSION = re.compile(r"\$\{\{\s*([\w.-]+)\s*\}\}")
_SHELL = ("bash", "--noprofile", "--norc", "-eo", "pipefail", "-c")
"""How a runner starts ``shell: bash``."""


class CompositeAction:
    """An action, and what its steps have written."""

    def __init__(self, folder: Path, workspace: Path, runner_temp: Path) -> None:
        """Read ``action.yml`` in ``folder``; it is used by a job in ``workspace``."""
        self.definition: dict[str, Any] = yaml.safe_load((folder / "action.yml").read_text())
        self._folder, self._workspace, self._temp = folder, workspace, runner_temp
        self.summary = runner_temp / "summary.md"

    @property
    def steps(self) -> list[dict[str, Any]]:
        """All steps, as they stand in the file."""
        return self.definition["runs"]["steps"]

    def run(self, extra: Mapping[str, str] | None = None, **inputs: str) -> int:
        """Run every shell step until one fails; the exit status of the last.

        Args:
            extra: environment of the job.
            inputs: of the action, with underscores for hyphens.
        """
        known = {name: str(given.get("default", "")) for name, given in self.definition["inputs"].items()}
        values = known | {name.replace("_", "-"): value for name, value in inputs.items()}
        assert values.keys() == known.keys()
        context = {f"inputs.{name}": value for name, value in values.items()}
        context |= {"github.action_path": str(self._folder), "runner.temp": str(self._temp)}
        for step in self.steps:
            if "run" in step and (status := self._play(step, context, extra or {})):
                return status
        return 0

    def _play(self, step: Mapping[str, Any], context: dict[str, str], extra: Mapping[str, str]) -> int:
        output = self._temp / "output"
        output.write_text("")
        environment = {name: _filled(value, context) for name, value in step.get("env", {}).items()}
        places = {
            "GITHUB_WORKSPACE": str(self._workspace),
            "GITHUB_OUTPUT": str(output),
            "GITHUB_STEP_SUMMARY": str(self.summary),
            "RUNNER_TEMP": str(self._temp),
        }
        status = subprocess.run(
            [*_SHELL, _filled(step["run"], context)],
            cwd=_filled(step.get("working-directory", str(self._workspace)), context),
            env={**os.environ, **places, **extra, **environment},
            capture_output=True,
        ).returncode
        if "id" in step:
            written = (line.partition("=") for line in output.read_text().splitlines())
            context |= {f"steps.{step['id']}.outputs.{name}": value for name, _, value in written}
        return status


def _filled(text: str, context: Mapping[str, str]) -> str:
    """The text with every ``${{ expression }}`` replaced; KeyError for one that nothing defines."""
    return _EXPRESSION.sub(lambda found: context[found[1]], text)
