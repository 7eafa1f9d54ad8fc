"""Errors of execution, shared by ``execute`` and the cluster's code."""


class ClusterError(ValueError):
    """A cluster that cannot run the study; the message names the fix."""
