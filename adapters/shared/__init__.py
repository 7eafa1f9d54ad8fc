"""Code shared by several adapters, or by the port and the base class. This package imports no engine."""
