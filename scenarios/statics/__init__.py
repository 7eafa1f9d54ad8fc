"""The judge: exact statics that decides whether a stack can stand, independent of the core that it judges."""
