"""What is computed from trials: groups, success rates, intervals, survival."""
