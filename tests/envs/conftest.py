"""Environments are drawn on no screen, and warnings are errors."""

import os

os.environ.setdefault("SDL_VIDEODRIVER", "dummy")
