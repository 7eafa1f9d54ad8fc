"""Import and export of scenes in the formats of robot simulators."""
