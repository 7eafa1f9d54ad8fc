"""Run one trial: build its scene in an engine, step it, monitor and judge it."""
