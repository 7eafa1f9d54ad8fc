"""Studies: their schema, selections, trials, policies and tolerances."""
