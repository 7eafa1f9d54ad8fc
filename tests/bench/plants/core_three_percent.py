"""Imported by a process under Callgrind: each frame of the core costs the instructions of ``EXTRA_INSTRUCTIONS`` more.

A loop without effect in ``StabilityExtension.update`` costs them. The loop stands in the method itself, because a call
of one function more costs above 3 % of a quiet frame.
"""

import ast
import inspect
import json
import os
import textwrap

from bench.machine import callgrind
from stability_core import extension
from tests.benchmarks import core_instructions

EXTRA = json.loads(os.environ["EXTRA_INSTRUCTIONS"])
"""Instructions to add to a frame, by the name of the frame."""
LOOP = """
for _ in steps:
    pass
"""
LONG = 2000
"""Number of steps of the loop that is counted to learn the cost of a step."""
steps: list[None] = []
"""The loop runs over this list."""


def _walk() -> None:
    for _ in steps:
        pass


class _CalibratedCounter(callgrind.CallgrindCounter):
    """Counter that knows the cost of a step of the loop."""

    step: float

    def __init__(self) -> None:
        super().__init__()
        for _ in range(3):  # Python specialises the loop in the first ones
            steps[:] = [None] * LONG
            long = self.count(_walk)
            steps.clear()
            _CalibratedCounter.step = (long - self.count(_walk)) / LONG


def _plant_loop() -> None:
    """Put the loop at the start of the method."""
    method = ast.parse(textwrap.dedent(inspect.getsource(extension.StabilityExtension.update)))
    method.body[0].body[1:1] = ast.parse(LOOP).body  # after the docstring
    names = vars(extension) | {"steps": steps}
    exec(compile(ast.fix_missing_locations(method), __file__, "exec", dont_inherit=True), names)
    extension.StabilityExtension.update = names["update"]


def _with_extra(frame, measure):
    def measured(count):
        steps[:] = [None] * round(EXTRA[frame] / _CalibratedCounter.step)
        return measure(count)

    return measured


_plant_loop()
callgrind.CallgrindCounter = _CalibratedCounter
core_instructions.quiet_blocks = _with_extra("quiet frame", core_instructions.quiet_blocks)
core_instructions.joining_frames = _with_extra("one plank more", core_instructions.joining_frames)
