"""Statistics of trials: groups, success rates, intervals and survival curves."""
