"""Comparison of two runs: regressions of outcome, changes of trajectory, regressions of time.

``baseline`` reads one side, from a results folder or a file. ``outcomes``, ``determinism`` and ``timing`` are the
gates. ``comparison`` combines the gates. ``render`` writes the result for people and for programs.
"""
