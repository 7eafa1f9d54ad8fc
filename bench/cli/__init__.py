"""The command line: one file a verb; ``app`` puts the verbs together, ``console`` is what they share."""
