"""The judge: whether a pile can stand, by exact statics. Written apart from the core that it judges."""
