"""The judge: exact statics that decides whether a stack can stand, written apart from the core that it judges."""
