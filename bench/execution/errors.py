"""The error that the command line and the code for clusters share."""


class ClusterError(ValueError):
    """Error of a run on a cluster; the message names the fix."""
