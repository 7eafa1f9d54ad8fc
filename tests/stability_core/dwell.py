"""The core's times, in frames of a host at 60 Hz."""

import math

from stability_core import Settings

FRAME_S = 1 / 60
_SETTINGS = Settings()
REST_FRAMES, LEAN_FRAMES, LOAD_FRAMES, CALM_FRAMES = (
    math.ceil(seconds / FRAME_S - 1e-6)
    for seconds in (_SETTINGS.rest_s, _SETTINGS.lean_s, _SETTINGS.load_s, _SETTINGS.calm_s)
)
