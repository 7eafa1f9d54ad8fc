"""Code shared by several adapters, or by the port and the base class. It imports no engine."""
