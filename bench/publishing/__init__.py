"""Make what readers get: replays and stills, the pages in docs/results, and generated blocks of the documents."""
