"""Publish: the studies and pages in docs/results, and the generated blocks of the documents."""
