"""Run the trials of a study, here or on a cluster, each in its own process, and write their results."""
