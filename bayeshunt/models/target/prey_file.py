"""A prey model written to a file: checksummed JSON of bins, counts and conditions."""

from __future__ import annotations

import os
from abc import ABC, abstractmethod
from typing import Any, Self

from bayeshunt.core.arguments import checked
from bayeshunt.core.bins import EffectAxes
from bayeshunt.core.errors import InputError, ModelFileError
from bayeshunt.files.records import RecordKind
from bayeshunt.models.counting.cells import MAX_DISTANCE_BINS
from bayeshunt.models.target.conditions import Conditions
from bayeshunt.models.target.expected import count_parts, plain_count

__all__ = ["PREY_FILES", "StoredPrey"]

#: Files of prey models: format 2 has room for conditions.
PREY_FILES = RecordKind("bayeshunt prey model", "bayeshunt prey fit tracks.parquet", versions=(1, 2))


class StoredPrey(ABC):
    """What is stored of a prey model, and made again; :class:`bayeshunt.models.target.prey.PreyModel` is one."""

    axes: EffectAxes
    conditions: Conditions | None

    @property
    @abstractmethod
    def _counts(self) -> dict[tuple[int, int, int], int]:
        """How often each cell was seen [2**-10]."""

    @abstractmethod
    def __init__(self, axes: EffectAxes | None = None) -> None:
        """Make an empty one."""

    @abstractmethod
    def _add(self, cell: tuple[int, int, int], count: int) -> None:
        """Count a cell."""

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the model as checksummed JSON: bins, counts and conditions; the file is replaced atomically."""
        extra = {} if self.conditions is None else {"conditions": self.conditions.to_dict()}
        PREY_FILES.save({**self.to_dict(), **extra}, path)

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Self:
        """Read a model written by :meth:`save`; raises ModelFileError in one clear line."""
        _, content = PREY_FILES.load(path)
        try:
            model = cls.from_dict(content)
            stored = content.get("conditions")
            model.conditions = None if stored is None else Conditions.from_dict(stored, model.axes)
        except (KeyError, TypeError, ValueError, OverflowError, AttributeError) as error:
            raise ModelFileError(f"{os.fspath(path)}: malformed content ({str(error).splitlines()[0]})") from None
        return model

    def to_dict(self) -> dict[str, Any]:
        """Return plain numbers for JSON: bins and [distance, angle, heading, count] rows in order, counts in 1/1024."""
        return {
            "distance_width": self.axes.distance.width,
            "distance_bins": self.axes.distance.bins,
            "angle_bins": self.axes.angle.bins,
            "heading_bins": self.axes.heading.bins,
            "counts": [[*cell, plain_count(self._counts[cell])] for cell in sorted(self._counts)],
        }

    @classmethod
    @checked
    def from_dict(cls, record: dict[str, Any]) -> Self:
        """Rebuild a model from :meth:`to_dict`; raises InputError if the record is not one."""
        try:
            axes = EffectAxes.standard(
                float(record["distance_width"]),
                distance_bin=1.0,
                angle_bins=int(record["angle_bins"]),
                heading_bins=int(record["heading_bins"]),
            ).extended(int(record["distance_bins"]))
            model = cls(axes)
            for distance, angle, heading, count in record["counts"]:
                model._add_checked((distance, angle, heading), count)
        except (KeyError, TypeError, ValueError, ZeroDivisionError) as error:
            raise InputError(f"not a stored prey model: {error}") from None
        return model

    def _add_checked(self, cell: tuple[int, int, int], count: float) -> None:
        limits = (MAX_DISTANCE_BINS, self.axes.angle.bins, self.axes.heading.bins)
        if not all(type(v) is int and 0 <= v < top for v, top in zip(cell, limits, strict=True)):
            raise ValueError(f"count row {[*cell, count]}")
        self._add(cell, count_parts(count))
