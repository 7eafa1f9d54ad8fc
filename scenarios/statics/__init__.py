"""The judge: exact statics that decides whether a stack can stand, independent of ``stability_core``."""
