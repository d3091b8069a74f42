"""Tracks cut into unbroken runs at one time-step: what windows, transitions and reports are made of."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pandas as pd

from bayeshunt.core.checks import check_number
from bayeshunt.core.errors import DataError, InputError
from bayeshunt.data.tracks import validate

__all__ = ["Run", "median_step", "native_step", "runs"]


@dataclass(frozen=True, eq=False)
class Run:
    """One individual's unbroken track on a regular clock.

    scene, individual: whose. start: time of the first sample [s]. stride: samples in one time-step.
    places: complex [N], x + i y. headings: [N], rad counter-clockwise of the body, NaN where the file has none.
    """

    scene: object
    individual: object
    start: float
    stride: int
    places: np.ndarray
    headings: np.ndarray


def native_step(tracks: pd.DataFrame) -> float:
    """Return the usual time [s] from one row of an individual to the next: the median over all."""
    gaps = [
        np.diff(np.sort(group.to_numpy(dtype=float))) for _, group in tracks.groupby(_keys(tracks), sort=False)["time"]
    ]
    every = np.concatenate(gaps) if gaps else np.zeros(0)
    every = every[every > 0]
    if not every.size:
        raise DataError("tracks: nobody has two rows at different times")
    return float(np.median(every))


def runs(tracks: pd.DataFrame, time_step: float | None = None) -> list[Run]:
    """Return the unbroken runs of every individual, resampled so that a whole number of samples makes ``time_step``.

    A run ends where more than one time-step (or one and a half rows) is missing; shorter holes are filled on
    a straight line. time_step: seconds, by default that of the rows. Order: as the individuals first appear.
    Raises DataError if ``tracks`` is no table of tracks, InputError for a time-step out of range.
    """
    validate(tracks)
    native = native_step(tracks)
    step = native if time_step is None else check_number(time_step, "time_step", "seconds > 0")
    if not step > 0:
        raise InputError(f"time_step: expected seconds > 0, got {time_step}")
    if step < 0.75 * native:
        raise InputError(f"time_step: {step:g} s is less than the {native:g} s between rows, where nothing is known")
    stride = max(1, round(step / native))
    found: list[Run] = []
    for (scene, individual), group in tracks.groupby(_keys(tracks), sort=False):
        found += _of_one(group, scene, individual, step, native, stride)
    return found


def _keys(tracks: pd.DataFrame) -> list[pd.Series]:
    scene = tracks["scene"] if "scene" in tracks else pd.Series("", index=tracks.index)
    return [scene, tracks["id"]]


def _of_one(
    group: pd.DataFrame, scene: object, individual: object, step: float, native: float, stride: int
) -> list[Run]:
    time = group["time"].to_numpy(dtype=float)
    order = np.argsort(time, kind="stable")
    order = order[np.concatenate([[True], np.diff(time[order]) > 1e-9])]
    time = time[order]
    places = group["x"].to_numpy(dtype=float)[order] + 1j * group["y"].to_numpy(dtype=float)[order]
    headings = group["heading"].to_numpy(dtype=float)[order] if "heading" in group else np.full(len(time), np.nan)
    cuts = np.flatnonzero(np.diff(time) > max(1.5 * native, step) + 1e-6 * step) + 1
    found = []
    for piece in np.split(np.arange(len(time)), cuts):
        if len(piece) < 2:
            continue
        grid = (
            time[piece[0]]
            + np.arange(int((time[piece[-1]] - time[piece[0]]) / step * stride + 1 + 1e-6)) * step / stride
        )
        found.append(
            Run(scene, individual, float(grid[0]), stride, *_sampled(grid, time[piece], places[piece], headings[piece]))
        )
    return found


def _sampled(
    grid: np.ndarray, time: np.ndarray, places: np.ndarray, headings: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    if len(grid) == len(time) and np.abs(grid - time).max() < 1e-3 * (grid[1] - grid[0]):
        return places, headings
    facing = np.exp(1j * headings)
    turned = np.interp(grid, time, facing.real) + 1j * np.interp(grid, time, facing.imag)
    placed = np.interp(grid, time, places.real) + 1j * np.interp(grid, time, places.imag)
    return placed, np.angle(turned)


def median_step(parts: list[Run]) -> float:
    """Return the median distance of one time-step over those that move (more than a tenth of the 90th percentile)."""
    steps = [np.abs(run.places[run.stride :] - run.places[: -run.stride]) for run in parts]
    every = np.concatenate(steps) if steps else np.zeros(0)
    if not every.size:
        raise DataError("tracks: no run is as long as one time-step; give a shorter one")
    moving = every[every > 0.1 * np.percentile(every, 90)]
    return float(np.median(moving)) if moving.size else float(every.max())
