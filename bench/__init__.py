"""The harness: plans trials, runs each in a process of its own, measures, and tells."""

from bench.machine.kernel_cache import keep_kernels_apart

keep_kernels_apart()  # before any module imports the core, and Numba with it
