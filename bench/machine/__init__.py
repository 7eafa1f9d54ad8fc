"""Describe the machine and the sources that a run takes place on."""
