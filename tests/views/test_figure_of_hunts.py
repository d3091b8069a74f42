"""The figure of hunts side by side: paths in their place, an ending for each."""

from __future__ import annotations

import numpy as np
import pytest

import bayeshunt as bh
from bayeshunt.core.errors import InputError
from bayeshunt.views.figures.hunts import hunts


@pytest.fixture(scope="module")
def episodes(khepera_model):
    return [
        bh.hunt("paper", bh.make_planner(name, khepera_model), arena=arena, theta=4.0, seed=1)
        for arena in ("walled", "open")
        for name in ("reactive", "prediction")
    ]


def test_every_hunt_gets_its_panel_paths_and_ending(episodes):
    panels = hunts(episodes).axes
    assert len(panels) == 4
    for panel, episode in zip(panels, episodes, strict=True):
        ending = f"caught, {episode.time:.1f} s" if episode.caught else "missed"
        place = episode.provenance
        assert panel.get_title(loc="left") == f"{place['planner']}, {place['arena']}\n{ending}"
        prey, hunter = (line for line in panel.lines if len(line.get_xdata()) == len(episode.trail) + 1)
        for line, who in ((prey, "prey"), (hunter, "hunter")):
            np.testing.assert_allclose(line.get_xdata()[1:], 1000 * episode.trail[f"{who}_x"])
            np.testing.assert_allclose(line.get_ydata()[1:], 1000 * episode.trail[f"{who}_y"])
            assert panel.get_xlim()[0] < line.get_xdata().min() <= line.get_xdata().max() < panel.get_xlim()[1]
            assert panel.get_ylim()[0] < line.get_ydata().min() <= line.get_ydata().max() < panel.get_ylim()[1]


def test_no_hunt_no_figure():
    with pytest.raises(InputError, match="at least one episode"):
        hunts([])
