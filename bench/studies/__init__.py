"""Plan what is run: studies and their schema, selections, trials, policies and tolerances."""
