"""Compile the core in the fork server, so that trials inherit the compiled kernels in memory."""

import logging
import os

from bench.execution.forkserver import CORE_LOG, WANTED_POLICIES
from stability_core import warm_up

logging.getLogger("stability_core").setLevel(os.environ[CORE_LOG])
for _policy in os.environ[WANTED_POLICIES].split(","):
    warm_up(_policy)
