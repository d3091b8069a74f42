"""What an answer rests on, in the same words in every display; what nobody knows is said to be unknown."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from bayeshunt.core.units import bounds, degrees, label, length
from bayeshunt.episodes.answers import stored

if TYPE_CHECKING:
    from bayeshunt.episodes.episode import Episode
    from bayeshunt.models.body.forward import ForwardModel
    from bayeshunt.models.body.posterior import Posterior

__all__ = [
    "NO_COUNTS",
    "SUMMED_OVER",
    "babbled",
    "beyond",
    "cell",
    "cell_within",
    "coordinate_used",
    "coordinates",
    "description",
    "energy",
    "how_sure",
    "interval",
    "known",
    "rows",
    "snapped",
    "support",
    "value_within",
    "within",
]

#: Why nothing is known of the rows behind an imported network.
NO_COUNTS = "an imported network carries no counts"
#: Where the low end of P(best gait) is below, the answer is not sure; from here on it is sure.
_UNSURE, _SURE = 0.5, 0.95
#: What a babbled row measured, in the order of every display.
_MEASURED: dict[str, Callable[[float], str]] = {
    "distance": length, "angle": degrees, "heading": degrees, "energy": lambda joules: f"{joules:.3g} J",
}  # fmt: skip
_NO_CHANCE = "the target itself has probability 0"
#: What the tables of a model that depends on the gait before are, unless it is asked for those after a gait.
SUMMED_OVER = "The gait before is summed over; model.after(gait) has the tables after one gait, with their counts."


def rows(support: Any) -> str:
    """Return "113 babbling rows", or "unknown" for None and for the missing value of a table."""
    if pd.isna(support):
        return "unknown"
    return f"{int(support)} babbling {'row' if support == 1 else 'rows'}"


def babbled(found: pd.DataFrame, most: int) -> tuple[list[str], list[list[str]]]:
    """Return column names and the first ``most`` babbled rows in words, a list each: their label, what they measured.

    A column that the rows lack is left out.
    """
    columns = [name for name in _MEASURED if name in found]
    lines = [[str(at), *(_MEASURED[c](float(row[c])) for c in columns)] for at, row in found.head(most).iterrows()]
    return ["row", *columns], lines


def support(answer: Posterior) -> str:
    """Return how many rows an answer rests on; where nobody knows, why."""
    words = rows(answer.support)
    if answer.model.backoff is not None and answer.model.known:
        return f"{words} after that gait, the rest from each gait's own table"
    return words if answer.model.has_counts else f"{words}: {NO_COUNTS}"


def energy(answer: Posterior) -> str:
    """Return what the most probable gait costs: "1.52 J (1.50 to 1.54, 430 rows)", after the gait before if known."""
    found = answer.model.energy(answer.best)
    if not len(found) or not found["rows"].iloc[0]:
        return f"of {answer.best}: unknown here"
    row = found.iloc[0]
    spread = f"{row['low_j']:.3g} to {row['high_j']:.3g}, " if pd.notna(row["low_j"]) else ""
    return f"of {answer.best}: {row['mean_j']:.3g} J ({spread}{rows(row['rows'])})"


def interval(answer: Posterior) -> pd.DataFrame | None:
    """Return the answer's 95 % interval; None where nobody knows the counts."""
    return answer.interval() if answer.model.has_counts else None


def within(found: pd.DataFrame) -> dict[str, tuple[float, float]]:
    """Return low and high by gait."""
    lows, highs = found["low"].tolist(), found["high"].tolist()
    return dict(zip(found.index, zip(lows, highs, strict=True), strict=True))


def value_within(episode: Episode) -> list[str]:
    """Return of each decision of a hunt the interval of the posterior that it rests on, " (0.31 to 1)"; "" without."""
    answers = [plan.answer for plan in episode.plans] or [None] * len(episode.frame)
    return [_value_within(*both) for both in zip(episode.frame.to_dict("records"), answers, strict=True)]


def _value_within(row: Mapping[Any, Any], answer: Posterior | None) -> str:
    if row["posterior"] is None:
        return ""
    if answer is not None:
        found = interval(answer)
        return "" if found is None else f" ({bounds(*within(found)[row['gait']])})"
    cells = stored(row)
    if cells is None or cells.within is None:
        return ""
    return f" ({bounds(*cells.within[:, int(np.argmax(row['posterior']))].tolist())})"


def cell_within(low: float, high: float) -> str:
    """Return the interval of a table's cell in words, as every table shows it: "0.911 to 0.978"."""
    return f"{low:.3f} to {high:.3f}"


def how_sure(answer: Posterior, found: pd.DataFrame) -> str:
    """Return in words whether the answer is sure, and what the interval supposes: "one row: not sure; ..."."""
    few = "one row" if answer.support == 1 else f"{answer.support} rows"
    low, _ = within(found)[answer.best]
    sure = f"{few}: not sure" if answer.support == 1 or low < _UNSURE else f"{few}: likely" if low < _SURE else few
    return f"{sure}; 95 % interval, {found.attrs['pseudo']}"


def snapped(answer: Posterior) -> str:
    """Return why another coordinate than the target's own answers, "" if its own does."""
    if not answer.snapped:
        return ""
    after = "".join(f" after {state}" for state in answer.model.known.values())
    why = f"the target itself was never babbled{after}" if answer.model.has_counts else _NO_CHANCE
    return f"nearest, {answer.missed_by}; {why}"


def beyond(answer: Posterior) -> str:
    """Return a note where the target lies beyond everything that a gait ever reached, "" elsewhere."""
    if not answer.beyond:
        return ""
    went = "ever went" if answer.model.has_counts else "goes"
    return (
        f"out of reach: no gait {went} farther than {length(answer.farthest)}, so this is the gait towards it, "
        "not one that gets there. Is what was asked in SI units?"
    )


def cell(answer: Posterior) -> str:
    """Return the coordinate that answered, bin by bin: "Distance 0-5.7 mm, Angle 30°"."""
    return ", ".join(f"{name} {label(bin_name)}" for name, bin_name in answer.cell.evidence.items())


def known(model: ForwardModel) -> str:
    """Return what else is known, to be put after other evidence: ", PreviousGait straight"; "" for nothing."""
    return "".join(f", {variable} {state}" for variable, state in model.known.items())


def coordinates(model: ForwardModel) -> str:
    """Return what the coordinates are that can answer."""
    return "learned coordinates" if model.has_counts else "coordinates of positive probability"


def coordinate_used(model: ForwardModel) -> str:
    """Return the name of the coordinate that answered."""
    return "learned coordinate" if model.has_counts else "coordinate used"


def description(model: ForwardModel) -> str:
    """Return the factors of a model's network, with the state of a cause that is known."""
    known = "".join(f", {variable} = {state}" for variable, state in model.known.items())
    return model.structure.describe().replace("| Gait)", f"| Gait{known})")
