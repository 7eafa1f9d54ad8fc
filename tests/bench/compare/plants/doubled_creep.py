# ruff: noqa: D100, E402 - appended to bench/trial.py of a copy of the suite
_creep = measure.creep
measure.creep = lambda *arguments: 2 * _creep(*arguments)
