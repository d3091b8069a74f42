"""Readers of recorded tracks, one module per format, behind a small registry."""

from bayeshunt.data.readers.registry import Found, TrackReader, find_reader, reader_names, register_reader

__all__ = ["Found", "TrackReader", "find_reader", "reader_names", "register_reader"]
