"""The scenes: one file each. What several of them need lies in ``shared``."""
