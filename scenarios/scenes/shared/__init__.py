"""Code that several scenes share, and transforms of a whole scene that the registry applies."""
