"""Statistics of trials: groups, success rates, intervals, survival."""
