"""Users' worlds with an attached extension, for ``tests.benchmarks.attach_cost``."""
