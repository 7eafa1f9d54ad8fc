"""Descriptions and measurements of the machine and of the sources of a run."""
