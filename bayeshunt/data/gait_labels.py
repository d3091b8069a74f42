"""Gait labels of a babbling table as text, however the column stores them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pandas as pd

from bayeshunt.core.errors import InputError
from bayeshunt.core.gaits import gait_name

__all__ = ["distinct", "name_of", "positions", "stored"]


def positions(values: pd.Series, names: Sequence[str]) -> np.ndarray:
    """Return the integer position [N] of each value among ``names`` (no two alike); -1 if it is not there.

    Values are compared as text, however they are stored: gait 1 is "1". They are compared once for each
    category or distinct value, or inside Arrow: never row by row in Python.
    """
    values = _plain(values)
    if getattr(values.dtype, "storage", None) == "pyarrow":
        import pyarrow as pa
        import pyarrow.compute as pc

        texts = pa.array(values.array)
        found = pc.index_in(texts, value_set=pa.array(names, type=texts.type))
        codes: np.ndarray = (found.fill_null(-1) if found.null_count else found).to_numpy()
        return codes
    if isinstance(values.dtype, pd.CategoricalDtype) and list(values.cat.categories) == list(names):
        return np.asarray(values.cat.codes)
    places, labels = distinct(values)
    index = {name: position for position, name in enumerate(names)}
    known = [*(-1 if name is None else index.get(name, -1) for name in labels), -1]
    found_at: np.ndarray = np.array(known)[places]
    return found_at


def _plain(values: pd.Series) -> pd.Series:
    """Arrow's own kinds of column as the ones that pandas has for the same: a dictionary as categories."""
    if not isinstance(values.dtype, pd.ArrowDtype):
        return values
    import pyarrow as pa

    chunked = pa.chunked_array(pa.array(values.array))
    if pa.types.is_string(chunked.type) or pa.types.is_large_string(chunked.type):
        return values.astype("string[pyarrow]")
    return pd.Series(chunked.combine_chunks().to_pandas())


def distinct(values: pd.Series) -> tuple[np.ndarray, list[str | None]]:
    """Return the position [N] of each value among the distinct ones (-1: missing), and their names (None: none)."""
    values = _plain(values)
    if isinstance(values.dtype, pd.CategoricalDtype):
        places, labels = np.asarray(values.cat.codes), list(values.cat.categories)
    else:
        try:
            places, found = pd.factorize(values)
        except TypeError:  # lists and the like
            return np.zeros(len(values), dtype=np.int64), [None]
        labels = list(found)
    return places, [name_of(label) for label in labels]


def name_of(label: Any) -> str | None:
    """Return a gait label as text; None if it is no name."""
    try:
        return gait_name(label)
    except InputError:
        return None


def stored(gaits: pd.Series) -> pd.Series:
    """Return the gait column as files hold it: labels that are not text as text."""
    places, names = distinct(gaits)
    kinds = gaits.cat.categories if isinstance(gaits.dtype, pd.CategoricalDtype) else gaits
    if isinstance(gaits.dtype, pd.ArrowDtype) or pd.api.types.infer_dtype(kinds, skipna=True) != "string":
        return pd.Series(np.array(names, dtype=object)[places], index=gaits.index, name=gaits.name)
    return gaits
