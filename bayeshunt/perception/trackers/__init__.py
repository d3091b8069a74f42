"""Trackers: what is believed after an observation."""
