"""Publish studies and pages in ``docs/results``, and fill the generated blocks of the documents."""
