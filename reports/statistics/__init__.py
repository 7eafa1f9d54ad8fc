"""Statistics of trials: groups, success rates, intervals, rankings, survival curves and steps."""
