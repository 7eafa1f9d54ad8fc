"""Scenes: bricks, timed actions on the bricks, and the outcome that theory demands."""
