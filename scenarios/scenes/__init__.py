"""The scenes, each in its own file; ``shared`` contains the code that several scenes use."""
