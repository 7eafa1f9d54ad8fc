"""Two runs held against each other: did stacking get worse, did trajectories change, did it get slower?

``baseline`` is one side, from a results folder or a file; ``outcomes``, ``determinism`` and ``timing`` are the gates,
pure functions of records; ``comparison`` puts them together; ``render`` writes it for people and for machines.
"""
