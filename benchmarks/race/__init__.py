"""Learning by trial against babbling: ``python -m benchmarks.race``."""
