"""Histories: a study run over many versions of an engine or of the suite, and the versions at which figures change."""
