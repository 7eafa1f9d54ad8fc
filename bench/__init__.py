"""The harness: plan trials, run each in a process of its own, measure, and report."""

from bench.machine.kernel_cache import keep_kernels_apart

keep_kernels_apart()  # before any module imports the core, and Numba with it
