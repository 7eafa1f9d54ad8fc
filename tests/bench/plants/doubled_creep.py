"""Imported in every trial's process of a run (see ``planted_bench``)."""

from bench.trial import measure

_creep = measure.creep
measure.creep = lambda *arguments: 2 * _creep(*arguments)
