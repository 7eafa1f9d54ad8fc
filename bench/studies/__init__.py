"""Studies and their schema, selections, trials, policies and tolerances."""
