"""A forward model written to files: its own format, CSV, and XMLBIF for other programs."""

from __future__ import annotations

import os
from abc import ABC, abstractmethod
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Self

import pandas as pd

from bayeshunt.core.arguments import checked
from bayeshunt.core.gaits import Gait
from bayeshunt.models.body.opening import OpenTables
from bayeshunt.models.formats import csv, model_file, xmlbif
from bayeshunt.models.tables.sources import TableSource
from bayeshunt.models.tables.structures import depends_on_previous

__all__ = ["WritableModel"]


class WritableModel(OpenTables, ABC):
    """What can be written and read; a forward model is one.

    provenance: where the rows came from.
    """

    provenance: Mapping[str, Any]

    @classmethod
    @abstractmethod
    def over(
        cls, source: TableSource, provenance: Mapping[str, Any] | None = None, data: tuple[pd.DataFrame, ...] = ()
    ) -> Self:
        """Return the model of a table source."""

    @abstractmethod
    def after(self, previous_gait: Gait | str | None) -> Self:
        """Return what each gait does right after ``previous_gait``."""

    @abstractmethod
    def _check_whole(self, what: str) -> None:
        """Raise InputError for the part of a model, which does not ``what`` by itself."""

    @property
    @abstractmethod
    def binned(self) -> Self:
        """The model with tables of the poses themselves."""

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the model as JSON (counts, prior, axes, gaits, provenance); see ``models.formats.model_file``."""
        self._check_whole("save")
        model_file.save(self, path)

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Self:
        """Read a model written by :meth:`save`; raises ModelFileError in one clear line."""
        return cls.over(*model_file.load(path))

    @classmethod
    @checked
    def loads(cls, text: str, name: str = "model") -> Self:
        """Return the model in the text of a model file; ``name`` is what a ModelFileError calls it."""
        return cls.over(*model_file.loads(text, name))

    def to_csv(self, folder: str | os.PathLike[str]) -> list[Path]:
        """Write every table as CSV, a row per cell with count and interval; see ``models.formats.csv``.

        Where the rows say what gaits cost, costs.csv has :meth:`energy`.
        """
        paths = csv.write(self.cells, folder, ("Gait", *self.structure.effects))
        return [*paths, *csv.write(lambda _: self.energy(), folder, ("costs",))] if self.knows_energy else paths

    def cells(self, variable: str) -> pd.DataFrame:
        """Return a table as one row per cell, as :meth:`to_csv` writes it; gaits vary slowest.

        Where the gait before is a cause, the effects' tables start with a column previous_gait.
        """
        axis = None if variable == "Gait" else self.axes[variable]
        if axis is None or not depends_on_previous(self.structure):
            return csv.cells(self.table(variable), axis)
        parts = {name: csv.cells(self.after(name).table(variable), axis) for name in self.gaits.names}
        return pd.concat(parts, names=["previous_gait"]).reset_index("previous_gait").reset_index(drop=True)

    def to_xmlbif(self, path: str | os.PathLike[str]) -> None:
        """Export as XMLBIF for other programs, with a map of state labels beside it: the tables of :attr:`binned`."""
        xmlbif.write(self.binned, path)
