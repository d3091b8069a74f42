"""The inverse model against full enumeration of the joint, pgmpy and pyAgrum, at 1e-12."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
import pandas as pd
import pytest
from model_cases import full_joint, random_model, repertoire

from bayeshunt.core.errors import ImpossibleEvidenceError
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.models.body.inverse import InverseModel
from bayeshunt.models.body.posterior import Posterior

gum = pytest.importorskip("pyagrum")

TOLERANCE = 1e-12
VARIABLES = ("Gait", "Distance", "Angle", "Heading")


def at(inverse: InverseModel, d: int, a: int, h: int | None = None, **settings: Any) -> Posterior:
    """The answer at the centre of a cell."""
    distance, angle, heading = (axis.centres for axis in inverse.model.axes)
    return inverse.posterior(distance[d], angle[a], None if h is None else heading[h], **settings)


def in_pyagrum(model: ForwardModel) -> Any:
    """The network in pyAgrum, built from the tables alone."""
    net = gum.BayesNet()
    for name in VARIABLES:
        size = len(model.probabilities(name))
        net.add(gum.LabelizedVariable(name, name, [f"s{i}" for i in range(size)]))
    for name in VARIABLES[1:]:
        net.addArc("Gait", name)
        for gait, column in enumerate(model.probabilities(name).T):
            net.cpt(name)[{"Gait": gait}] = column.tolist()
    net.cpt("Gait").fillWith(model.probabilities("Gait").tolist())
    return net


def ask_pyagrum(net: Any, bins: dict[str, int]) -> np.ndarray:
    engine = gum.LazyPropagation(net)
    engine.setEvidence(bins)
    engine.makeInference()
    return engine.posterior("Gait").toarray().ravel()


def ask_pgmpy(model: ForwardModel, evidence: dict[str, str]) -> np.ndarray:
    from pgmpy.inference import VariableElimination

    answer = VariableElimination(model.network).query(["Gait"], evidence=evidence, show_progress=False)
    return np.array([answer.get_value(Gait=name) for name in model.gaits.names])


def check_by_enumeration(model: ForwardModel) -> None:
    """Every (Distance, Angle) and every (Distance, Angle, Heading): value or typed refusal."""
    joint, inverse = full_joint(model), InverseModel(model)
    _, distances, angles, headings = joint.shape
    for d, a, h in itertools.product(range(distances), range(angles), [None, *range(headings)]):
        mass = joint[:, d, a].sum(axis=1) if h is None else joint[:, d, a, h]
        if mass.sum() == 0:
            with pytest.raises(ImpossibleEvidenceError):
                at(inverse, d, a, h, snap=False)
            continue
        answer = at(inverse, d, a, h, snap=False)
        assert answer.evidence_probability == pytest.approx(mass.sum(), rel=TOLERANCE)
        np.testing.assert_allclose(answer.values, mass / mass.sum(), rtol=0, atol=TOLERANCE)
        assert (answer.cell.distance_bin, answer.cell.angle_bin, answer.cell.heading_bin) == (d, a, h)
        seen = model.joint.cells[:, 1:] == [d, a, h] if h is not None else model.joint.cells[:, 1:3] == [d, a]
        assert answer.support == model.joint.counts[seen.all(axis=1)].sum()


def check_by_engines(model: ForwardModel, questions: int, *, rng: np.random.Generator) -> int:
    """Possible evidence drawn at random, asked of both engines.

    Returns how many answers left more than one gait possible: where only one is, engines agree
    whatever they compute, so those prove little.
    """
    joint, inverse, net = full_joint(model), InverseModel(model), in_pyagrum(model)
    possible = np.argwhere(joint.sum(axis=0) > 0)
    chosen = possible[rng.integers(0, len(possible), questions)].tolist()
    open_ = 0
    for number, (d, a, h) in enumerate(chosen):
        answer = at(inverse, d, a, h if number % 2 else None, snap=False)
        bins = {"Distance": d, "Angle": a, **({"Heading": h} if number % 2 else {})}
        np.testing.assert_allclose(ask_pyagrum(net, bins), answer.values, rtol=0, atol=TOLERANCE)
        np.testing.assert_allclose(ask_pgmpy(model, answer.evidence), answer.values, rtol=0, atol=TOLERANCE)
        open_ += int(answer.values.max() < 1.0)
    return open_


@pytest.mark.parametrize("block", range(8))
def test_200_random_networks(block: int) -> None:
    rng = np.random.default_rng(block)
    open_ = 0
    for seed in range(25 * block, 25 * block + 25):
        model = random_model(seed)
        check_by_enumeration(model)
        open_ += check_by_engines(model, 4, rng=rng)
    assert open_ > 30


def test_random_networks_are_worth_testing() -> None:
    models = [random_model(seed) for seed in range(200)]
    zeros = [np.mean(model.probabilities("Angle") == 0) for model in models]
    impossible = [np.mean(full_joint(model).sum(axis=(0, 3)) == 0) for model in models]
    assert len({(len(m.gaits), *m.axes.shape) for m in models}) > 100
    assert np.mean(np.array(zeros) > 0) > 0.4
    assert np.mean(np.array(impossible) > 0) > 0.3
    assert sum(m.prior > 0 for m in models) > 40


def test_fitted_model(model: ForwardModel) -> None:
    check_by_enumeration_of_learned_cells(model)
    check_by_engines(model, 60, rng=np.random.default_rng(1))


def test_fitted_model_with_a_prior(frame: pd.DataFrame) -> None:
    """Every gait keeps mass everywhere, so that every answer is a real one."""
    smoothed = ForwardModel.fit(frame, repertoire(), prior=0.5)
    check_by_enumeration_of_learned_cells(smoothed)
    assert check_by_engines(smoothed, 60, rng=np.random.default_rng(2)) == 60


def check_by_enumeration_of_learned_cells(model: ForwardModel) -> None:
    joint, inverse = full_joint(model).sum(axis=3), InverseModel(model)
    learned = np.argwhere(model.joint.support > 0).tolist()
    assert len(learned) > 50
    for d, a in learned:
        answer = at(inverse, d, a)
        assert not answer.snapped
        assert answer.evidence_probability == pytest.approx(joint[:, d, a].sum(), rel=1e-10)
        np.testing.assert_allclose(answer.values, joint[:, d, a] / joint[:, d, a].sum(), rtol=0, atol=TOLERANCE)


def test_both_engines_ask_the_network_of_the_model(model: ForwardModel) -> None:
    """The pgmpy network handed out is the one whose tables the answers come from."""
    answer = InverseModel(model).posterior(0.15, 0.3)
    np.testing.assert_allclose(ask_pgmpy(model, answer.evidence), answer.values, rtol=0, atol=TOLERANCE)
