"""Shared by all tests."""

from __future__ import annotations

from hypothesis import settings

import bench  # noqa: F401 - chooses where kernels are cached, before a test imports the core

# No deadline: the first example of a kernel compiles it, and these machines are noisy.
# Derandomised: a run of CI must not fail by the luck of the draw.
settings.register_profile("stillstack", deadline=None, derandomize=True)
settings.load_profile("stillstack")
