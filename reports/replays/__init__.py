"""Replays, animations and stills of recorded trials."""
