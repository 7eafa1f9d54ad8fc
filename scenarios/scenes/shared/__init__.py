"""Code that several scenes share, and the registry's transforms of a whole scene."""
