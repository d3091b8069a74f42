"""The file in which the figures of ``python -m benchmarks.sensing`` add up, a line a figure: a run can go on."""

from __future__ import annotations

import csv
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import NamedTuple

from bayeshunt.experiments.scores import wilson_interval

__all__ = ["Key", "Results", "pooled"]


class Key(NamedTuple):
    """What was measured: a row, who hunted and tracked, the evaluation seed, how many runs a bearing."""

    row: str
    planner: str
    tracker: str
    seed: int
    runs: int


class Results:
    """Figures by what was measured; those that are in the file are not measured again."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self._known: dict[Key, dict[str, float]] = {}
        if path.exists():
            with path.open(newline="", encoding="utf-8") as file:
                for row, planner, tracker, seed, runs, measure, value in list(csv.reader(file))[1:]:
                    key = Key(row, planner, tracker, int(seed), int(runs))
                    self._known.setdefault(key, {})[measure] = float(value)

    def get(self, key: Key, name: str, measure: Callable[[], Mapping[str, float]]) -> dict[str, float]:
        """Return the figures ``name.*`` of a key: those of the file, or measured and written to it."""
        found = {m.split(".", 1)[1]: v for m, v in self._known.get(key, {}).items() if m.startswith(f"{name}.")}
        if found:
            return found
        found = {measured: float(value) for measured, value in measure().items()}
        self._known.setdefault(key, {}).update({f"{name}.{measured}": value for measured, value in found.items()})
        self._write(key, {f"{name}.{measured}": value for measured, value in found.items()})
        return found

    def _write(self, key: Key, figures: Mapping[str, float]) -> None:
        begun = self.path.exists()
        self.path.parent.mkdir(parents=True, exist_ok=True)
        with self.path.open("a", newline="", encoding="utf-8") as file:
            lines = csv.writer(file, lineterminator="\n")
            if not begun:
                lines.writerow([*Key._fields, "measure", "value"])
            lines.writerows([*key, measure, f"{value:.6g}"] for measure, value in figures.items())


def pooled(parts: Iterable[Mapping[str, float]]) -> dict[str, float]:
    """Return success, interval and mean time [s] over all hunts of several seeds.

    Each part: caught, hunts, and the sums of the times [s] and of their squares.
    """
    caught, hunts, total, squares = (
        sum(values) for values in zip(*((p["caught"], p["hunts"], p["time"], p["squares"]) for p in parts), strict=True)
    )
    low, high = wilson_interval(int(caught), int(hunts))
    mean = total / hunts
    spread = max(squares / hunts - mean**2, 0.0) ** 0.5
    return {
        "caught": int(caught), "hunts": int(hunts), "success": caught / hunts, "low": low, "high": high, "time": mean,
        "time_se": spread / hunts**0.5,
    }  # fmt: skip
