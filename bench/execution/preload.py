"""The module that the fork server imports last, to load the modules for all trials.

The module registers the engines outside this repository, because a trial inherits the registry of the server. It also
excludes the loaded objects from garbage collection. Otherwise the first collection in each trial would touch, and
thereby copy, the memory that all trials share.
"""

import email.parser  # noqa: F401 - importlib.metadata loads it to read an engine's version
import gc

import numpy.ma  # noqa: F401 - NumPy loads it for the first percentile

from adapters import register_external

register_external()
gc.collect()
gc.freeze()
