"""Sensors: what is seen of a run."""
