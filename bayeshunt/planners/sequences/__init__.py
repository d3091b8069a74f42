"""Hunters that follow every short gait sequence along its mean path: frugal, and those that remember earlier prey."""
