"""The scenes, one file each; ``shared`` holds the code that several scenes use."""
