"""Modules that several ports share, such as contact areas and approach velocities; the suite's adapters use some."""
