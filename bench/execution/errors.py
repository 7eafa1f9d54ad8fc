"""Errors of execution, shared by the command line and the code for clusters."""


class ClusterError(ValueError):
    """A cluster that cannot run the study; the message names the fix."""
