"""Choice of the contacts that touch a live body."""

from __future__ import annotations

import numpy as np

from adapters.shared.bodies import Bodies
from stability_core.port import GROUND, Contacts


def of_live(contacts: Contacts, bodies: Bodies) -> Contacts:
    """Return the contacts that touch a live body and no removed one."""
    live, there = bodies.live, bodies.bricks
    kept = [
        (a in live or b in live) and (a in there or a <= GROUND) and (b in there or b <= GROUND)
        for a, b in zip(contacts.body_a.tolist(), contacts.body_b.tolist(), strict=True)
    ]
    return contacts if all(kept) else contacts.chosen(np.array(kept, np.bool_))
