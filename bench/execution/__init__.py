"""Run the trials of a study on this machine or on a cluster, each in its own process, and write their results."""
