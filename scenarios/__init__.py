"""Scenes: bricks, the time at which each is placed, and the outcome that theory demands."""
