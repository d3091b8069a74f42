"""What a replay shows of a hunter that sees by a camera: what it believed, and where it looked."""

from __future__ import annotations

from typing import Any

import numpy as np

from bayeshunt.config.schema import ExperimentSettings
from bayeshunt.core.geometry import Polar, Pose
from bayeshunt.views.pages.page import number
from bayeshunt.views.sheets.belief import cell_names

__all__ = ["belief_of", "field_of_view"]


def field_of_view(settings: ExperimentSettings) -> list[float] | None:
    """Half the field of view [rad] and the reach of the hunter's camera [m]; None where it has none."""
    if settings.sensing.sensor != "camera":
        return None
    camera = settings.sensing.camera
    return [round(0.5 * camera.fov, 4), round(camera.reach(camera.target_width or settings.prey.body.diameter), 3)]


def belief_of(row: dict[str, Any], hunter: Pose) -> dict[str, Any] | None:
    """Where the prey may be, what was sighted in the step before, and the table of it; None where it is told."""
    if not isinstance(row.get("cloud_distance"), (list, np.ndarray)):
        return None

    def places(name: str) -> list[list[float]]:
        distance, angle = (np.asarray(row[f"{name}_{k}"], dtype=float) for k in ("distance", "angle"))
        known = np.isfinite(distance)
        spots = hunter.compose(Polar(distance[known], angle[known], np.zeros(int(known.sum()))))
        return np.stack(spots[:2], axis=1).round(4).tolist()  # type: ignore[no-any-return]

    cells = [] if row["belief_table"] is None else [list(map(float, cell)) for cell in row["belief_table"]]
    return {
        "cloud": places("cloud"),
        "sighted": places("sighted"),
        "spread": number(row["belief_spread"]),
        "resultant": number(row["belief_resultant"]),
        "lastSeen": number(row["belief_last_seen"]),
        "inView": number(row["belief_in_view"]),
        "table": [[*cell_names(cell), round(cell[4], 4), round(cell[5], 2)] for cell in cells],
    }
