"""The harness: plans trials, runs each in a process of its own, measures, and tells."""
