"""Tables out as CSV, a row per cell."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pandas as pd

from bayeshunt.core.bins import Axis
from bayeshunt.core.errors import InputError
from bayeshunt.files.atomic import check_path, write_text
from bayeshunt.models.tables.probability_table import ProbabilityTable

__all__ = ["cells", "write"]


def write(table: Callable[[str], pd.DataFrame], folder: str | os.PathLike[str], variables: Sequence[str]) -> list[Path]:
    """Write gait.csv, distance.csv, ... into ``folder``, one of each variable; returns the paths.

    table: gives the rows of a variable, see :func:`cells`. Numbers are written in full.
    """
    place, paths = Path(check_path(folder, "the name of a folder", InputError)), []
    for variable in variables:
        path = place / f"{variable.lower()}.csv"
        write_text(path, table(variable).to_csv(index=False, lineterminator="\n"))
        paths.append(path)
    return paths


def cells(shown: ProbabilityTable, axis: Axis | None) -> pd.DataFrame:
    """Return a table as one row per cell; gaits vary slowest.

    axis: the bins; None for P(Gait). Columns: gait, bin, low and high (edges of the bin, m, rad or J; not of P(Gait)),
    probability, count, ci_low and ci_high (95 % credible interval). Of an imported network nobody knows the counts:
    those three columns are empty; so are the intervals of a P(Gait) that is set to uniform.
    """
    values = shown.probability.to_numpy()
    bins, columns = values.shape
    if axis is None:
        frame = pd.DataFrame({"gait": shown.probability.index})
    else:
        frame = pd.DataFrame({"gait": np.repeat(list(shown.probability.columns), bins)})
        for name, part in (("bin", axis.labels), ("low", axis.edges[:-1]), ("high", axis.edges[1:])):
            frame[name] = np.tile(np.asarray(part), columns)
    frame["probability"] = values.T.ravel()
    counted = {"count": shown.count, "ci_low": shown.low, "ci_high": shown.high}
    for name, table in counted.items():
        frame[name] = None if table is None else table.to_numpy().T.ravel()
    return frame
