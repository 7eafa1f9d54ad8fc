"""Run the trials of a study, here or on a cluster, each in a process of its own, and write their results."""
