"""Modules that the fork server imports last, so that no trial pays for imports that all of them need.

Engines from outside this repository are added here, because the trials know the engines that the server knows.

The loaded objects are excluded from garbage collection, because each trial's first collection would touch, and thereby
copy, the memory that all trials share.
"""

import email.parser  # noqa: F401 - importlib.metadata loads it to read an engine's version
import gc

import numpy.ma  # noqa: F401 - NumPy loads it for the first percentile

from adapters import register_external

register_external()
gc.collect()
gc.freeze()
