"""Paths as complex numbers: rows of tables of transitions, and places, turned so that the present faces forward."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from bayeshunt.core.geometry import FloatArray
from bayeshunt.data.transitions import STANDING_SHARE, window_columns, windows_of

if TYPE_CHECKING:
    import pandas as pd

__all__ = ["forward_facing", "paths_of"]


def forward_facing(
    paths: FloatArray, seen: int, scale: float, headings: FloatArray | None = None
) -> tuple[FloatArray, FloatArray]:
    """Return the paths [N, T + S] with the place ``seen - 1`` at 0 and facing forward, and the direction [N] that was.

    The direction is that of the last step seen that is longer than a tenth of ``scale``; without any, that of the body
    (``headings`` [N], rad counter-clockwise, NaN where unknown); without that either, the path is left as it lies.
    """
    steps = np.diff(paths[:, :seen], axis=1)
    moved = np.abs(steps) > STANDING_SHARE * scale
    last = seen - 2 - np.argmax(moved[:, ::-1], axis=1)
    step = steps[np.arange(len(paths)), last]
    body = 1.0 if headings is None else np.where(np.isfinite(headings), np.exp(1j * np.nan_to_num(headings)), 1.0)
    turn = np.where(moved.any(axis=1), step / np.where(np.abs(step) > 0, np.abs(step), 1.0), body)
    return (paths - paths[:, seen - 1 : seen]) * np.conj(turn)[:, None], turn


def paths_of(transitions: pd.DataFrame, seen: int, steps: int) -> FloatArray:
    """Return the whole paths complex [N, seen + steps] of rows that have all of it; the present is at 0."""
    there, ahead = windows_of(transitions.columns)
    if there < seen or ahead < steps:
        return np.zeros((0, seen + steps), dtype=complex)
    values = transitions[window_columns(seen, steps)].to_numpy(dtype=float).reshape(len(transitions), -1, 2)
    values = values[np.isfinite(values).all(axis=(1, 2))]
    places = values[..., 0] - 1j * values[..., 1]  # left is positive
    past, future = places[:, : seen - 1][:, ::-1], places[:, seen - 1 :]
    return np.concatenate([past, np.zeros((len(values), 1)), future], axis=1)
