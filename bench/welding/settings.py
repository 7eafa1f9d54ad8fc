"""The tolerances of the welding policies, each with unit and reason.

The values are choices of this suite, because the article's values are unknown.

As in the core, the unit of a speed is sqrt(gravity times size). The size of a body is the distance from its centre to
its farthest contact point.
"""

from __future__ import annotations

from stability_core.settings import Settings

CORE = Settings()
"""The core's tolerances. The welding policies take rest, touch and impact from the core, so that all policies agree."""
REVIEW_S = 0.1
"""Time [s] between two reviews of all bodies, equal to the core's ``rest_s``. An event, such as an impact, brings the
next review forward."""
MAX_RESIDUAL = 0.01
"""Greatest force and moment that a body in equilibrium may lack, as a share of its load, and of load times size.

On a plank of size 60 mm a load 0.6 mm outside the contact area lacks this moment. Engines report contact points with an
accuracy of 0.1 mm."""
FAILURES = 2
"""Number of reviews in succession that a joined body must fail before it is parted, because engines drop single contact
points for a frame. The second review follows in the next frame."""
DEGREE = 3
"""Number of joints of a body from which a review closes no more loops at this body. Loops make an assembly stiff, but
cost iterations and leave internal stress. The joints that connect a group have no limit."""
