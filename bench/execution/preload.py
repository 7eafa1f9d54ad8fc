"""Imported last by the server from which trials are forked, so that no trial pays for what all of them need.

Engines from outside this repository are added here, because the trials know the engines that the server knows.

What the server has loaded is never looked through for garbage: each trial's first collection would touch, and thereby
copy, the memory that all trials share.
"""

import email.parser  # noqa: F401 - importlib.metadata loads it to tell an engine's version
import gc

import numpy.ma  # noqa: F401 - NumPy loads it when the first percentile is asked for

from adapters import register_external

register_external()
gc.collect()
gc.freeze()
