"""Hunters that minimise the expected time of the capture over two gaits, against the futures of a prey that turns."""
