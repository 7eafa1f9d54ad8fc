"""Imported in every trial's process of a run (see ``planted_bench``)."""

from dataclasses import replace

from bench.trial import creep

_creep_of = creep.creep_of


def _doubled(*arguments):
    found = _creep_of(*arguments)
    return replace(found, speed_m_s=2 * found.speed_m_s, error_m_s=2 * found.error_m_s)


creep.creep_of = _doubled
