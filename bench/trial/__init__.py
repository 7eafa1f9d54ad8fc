"""Run one trial: build its scene in an engine, step the engine, and monitor and judge the stack."""
