"""Arrays of a frame in which the core has nothing to read."""

from __future__ import annotations

import numpy as np

from stability_core.port import Contacts, Masses

NO_CONTACTS = Contacts.empty()
NO_MASSES = Masses(np.empty(0, np.int64), np.empty(0), np.empty((0, 3)))
