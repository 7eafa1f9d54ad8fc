"""Appended to bench/trial.py of a copy of the suite."""

from bench import measure

_creep = measure.creep
measure.creep = lambda *arguments: 2 * _creep(*arguments)
