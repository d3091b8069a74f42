"""Environments are drawn on no screen, and warnings are errors."""

import os
import warnings

os.environ.setdefault("SDL_VIDEODRIVER", "dummy")

with warnings.catch_warnings():
    warnings.simplefilter("ignore")  # a warning of SWIG that is made an error crashes the import
    import Box2D  # noqa: F401
