"""The reactive and the prediction hunter against posteriors computed by hand."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from planner_cases import BODY, babble, situations

import bayeshunt as bh
from bayeshunt.core.errors import InputError
from bayeshunt.core.geometry import Polar
from bayeshunt.data.babbling_table import discretise
from bayeshunt.models.target.prey import PreyModel
from bayeshunt.planners.api import Situation
from bayeshunt.planners.paper.prediction import steps_ahead
from bayeshunt.planners.registry import make_planner


def plan(planner, situation):
    return planner.plan(situation, rng=np.random.default_rng(0))


def hand_posterior(model, distance: float, angle: float) -> tuple[np.ndarray, float, tuple[int, int]]:
    """P(Gait | D, A) and P(D, A) in the target's own learned cell, or else in the nearest one."""
    rows = discretise(babble(list(model.gaits.names), 1500, seed=5), model.gaits, model.axes)
    cells = sorted({(int(d), int(a)) for _, d, a, _ in rows})
    own = (model.axes.distance.index(distance), model.axes.angle.index(angle))
    if own not in cells:
        centres = [Polar(model.axes.distance.centres[d], model.axes.angle.centres[a], 0.0) for d, a in cells]
        target = Polar(distance, angle, 0.0)
        gaps = [math.hypot(c.forward - target.forward, c.right - target.right) for c in centres]
        own = cells[int(np.argmin(gaps))]
    joint = model.probabilities("Gait") * model.probabilities("Distance")[own[0]] * model.probabilities("Angle")[own[1]]
    return joint / joint.sum(), float(joint.sum()), own


def check_against_hand(found, model) -> None:
    posterior, evidence, cell = hand_posterior(model, found.target.distance, found.target.angle)
    assert found.posterior == pytest.approx(posterior, abs=1e-12)
    assert found.gait == model.gaits.names[int(np.argmax(posterior))]
    assert found.gaits == (found.gait,)
    assert found.value == pytest.approx(posterior.max(), abs=1e-12)
    assert found.evidence_probability == pytest.approx(evidence, rel=1e-12)
    trace = found.trace
    assert trace["posterior"].tolist() == found.posterior.tolist()
    assert trace["gait"].tolist() == list(model.gaits.names)
    assert trace.loc[trace["chosen"], "gait"].tolist() == [found.gait]
    assert (trace["distance_bin"] == cell[0]).all()
    assert (trace["angle_bin"] == cell[1]).all()
    assert (trace["support"] == found.support).all()
    assert found.support >= 1


@pytest.mark.parametrize("name", ["reactive", "prediction"])
def test_a_planner_may_ask_how_sure_its_posterior_is(model, name):
    planner = make_planner(name, model)
    for situation in situations(5):
        found, same = plan(planner, replace(situation, interval=0.9)), plan(planner, situation)
        ends = found.answer.interval(0.9)
        assert found.trace["low"].tolist() == ends["low"].tolist()
        assert found.trace["high"].tolist() == ends["high"].tolist()
        assert found.trace.drop(columns=["low", "high"]).equals(same.trace)
        assert (found.gait, found.value) == (same.gait, same.value)
    with pytest.raises(InputError, match=r"interval: expected a probability between 0 and 1, got 1\.0"):
        replace(situation, interval=1.0)


def test_nobody_knows_how_sure_an_imported_network_is(model, tmp_path):
    model.to_xmlbif(tmp_path / "model.xmlbif")
    imported = bh.import_network(tmp_path / "model.xmlbif")
    with pytest.raises(InputError, match="no counts"):
        plan(make_planner("reactive", imported), replace(situations(1)[0], interval=0.9))


def test_reactive_is_the_argmax_of_the_posterior_at_the_preys_position(model):
    planner = make_planner("reactive", model)
    chosen = set()
    for situation in situations(25):
        found = plan(planner, situation)
        assert found.target == situation.prey
        assert not found.prey_known
        check_against_hand(found, model)
        chosen.add(found.gait)
    assert len(chosen) > 2


def test_prediction_is_the_argmax_at_the_predicted_position(model):
    planner = make_planner("prediction", model)
    for situation in situations(25):
        found = plan(planner, situation)
        steps = steps_ahead(situation.prey.distance, BODY)
        expected = situation.prey.compose(situation.prey_model.predict(steps))
        assert found.target.distance == pytest.approx(expected.distance, abs=1e-12)
        assert math.cos(found.target.angle - expected.angle) == pytest.approx(1.0, abs=1e-12)
        assert len(found.predicted_prey.distance) == steps + 1
        assert found.prey_known
        check_against_hand(found, model)


def test_prediction_without_a_prey_model_aims_at_the_present_position_and_says_so(model):
    for situation in situations(5, known=False):
        found = plan(make_planner("prediction", model), situation)
        reactive = plan(make_planner("reactive", model), situation)
        assert not found.prey_known
        assert found.target == situation.prey
        assert found.gait == reactive.gait


@pytest.mark.parametrize(
    ("bodies", "steps"),
    [(0.0, 0), (0.99, 0), (1.0, 1), (2.5, 1), (2.99, 1), (3.0, 2), (5.0, 3), (6.99, 3), (7, 4)],
)
def test_half_the_distance_rounds_half_up(bodies, steps):
    # 5 bodies: half of it is 2.5, which is 3 (Python's round() gives 2).
    assert steps_ahead(bodies * BODY, BODY) == steps


def test_rounding_does_not_hang_on_the_last_bit():
    assert steps_ahead(math.nextafter(5 * BODY, 0.0), BODY) == 3


def test_a_tie_goes_to_the_first_gait(small_model):
    """Three gaits that are equally probable: table order decides."""

    class Even:
        def __init__(self, inverse):
            self.inverse = inverse

        def after(self, previous_gait):
            return self

        def posterior(self, distance, angle):
            answer = self.inverse.posterior(distance, angle)

            class Answer:
                values = np.full(3, 1 / 3)
                evidence_probability, support, cell = 1.0, 1, answer.cell

            return Answer()

    planner = make_planner("reactive", small_model)
    planner.inverse = Even(planner.inverse)
    assert plan(planner, situations(1)[0]).gait == "straight"


def test_a_prey_on_top_of_the_hunter_gets_the_nearest_cell(model):
    rows = discretise(babble(list(model.gaits.names), 1500, seed=5), model.gaits, model.axes)
    for name in ("reactive", "prediction"):
        found = plan(make_planner(name, model), Situation(Polar(0.0, 0.0, 0.0), PreyModel()))
        assert (found.trace["distance_bin"] == rows[:, 1].min()).all()
        assert found.value == found.posterior.max()
