"""Imported by the server from which trials are forked: they find the core compiled in memory."""

import os

from bench.execution.forkserver import WANTED_POLICIES
from stability_core import warm_up

for _policy in os.environ[WANTED_POLICIES].split(","):
    warm_up(_policy)
