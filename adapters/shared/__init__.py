"""Parts that several adapters, or the port and the base class, have in common; they know no engine."""
