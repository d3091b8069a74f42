"""From body parts to one point: a keypoint by name, or the centroid weighted by confidence."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd

from bayeshunt.core.errors import InputError

__all__ = ["one_point"]


def one_point(
    places: np.ndarray,
    confidence: np.ndarray | None,
    names: Sequence[str],
    ids: Sequence[str],
    frames: np.ndarray,
    keypoint: str | None,
) -> tuple[pd.DataFrame, str]:
    """Return columns id, frame, x, y, confidence of every individual, and a note of which point it is.

    places: [I, N, K, 2], individuals, frames, keypoints; NaN where not seen. confidence: [I, N, K], None if unknown.
    names: the K keypoints. ids: the I individuals. frames: [N], numbers of the frames.
    Raises InputError for a keypoint that is not there.
    """
    seen = np.isfinite(places).all(axis=3)
    weights = np.where(seen, 1.0 if confidence is None else np.nan_to_num(confidence), 0.0)
    if keypoint is not None:
        if keypoint not in names:
            raise InputError(f"unknown keypoint {keypoint!r}: expected one of {', '.join(names)}")
        weights = weights * (np.asarray(names) == keypoint)
        note = f"the point followed is {keypoint!r}"
        weights = np.where((weights == 0) & seen & (np.asarray(names) == keypoint), 1e-9, weights)
    else:
        note = f"the point followed is the centroid of {len(names)} keypoints, weighted by confidence"
    totals = weights.sum(axis=2)
    with np.errstate(invalid="ignore", divide="ignore"):
        centre = (weights[..., None] * np.where(seen[..., None], places, 0.0)).sum(axis=2) / totals[..., None]
        sure = (weights**2).sum(axis=2) / totals  # confidence of the parts that made the point
    frame = pd.DataFrame(
        {
            "id": np.repeat(np.asarray(ids, dtype=object), places.shape[1]),
            "frame": np.tile(np.asarray(frames), len(ids)),
            "x": centre[..., 0].ravel(),
            "y": centre[..., 1].ravel(),
            "confidence": np.nan if confidence is None else sure.ravel(),
        }
    )
    return frame, note
