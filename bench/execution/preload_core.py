"""Compile the core in the fork server, so that trials inherit the compiled kernels in memory."""

import os

from bench.execution.forkserver import WANTED_POLICIES
from stability_core import warm_up

for _policy in os.environ[WANTED_POLICIES].split(","):
    warm_up(_policy)
