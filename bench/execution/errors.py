"""Errors that both the choice of where to run and the cluster's own code raise."""


class ClusterError(ValueError):
    """A cluster that cannot run the study; the message names the fix."""
