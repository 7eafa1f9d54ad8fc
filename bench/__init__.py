"""The harness, which plans trials, runs each trial in its own process, measures the scene and reports the results."""

from bench.machine.kernel_cache import keep_kernels_apart

keep_kernels_apart()  # before any module imports the core, and Numba with it
