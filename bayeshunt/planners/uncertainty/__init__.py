"""Planners that decide on a belief: sampled futures, and what it costs not to see the prey."""
