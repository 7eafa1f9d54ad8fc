"""Describe the machine and the sources of a run."""
