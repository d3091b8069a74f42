"""1,000 random networks, 20 questions each: our answers, pgmpy's and pyAgrum's agree at 1e-12."""

import numpy as np
import pytest
from model_cases import full_joint, random_model

from bayeshunt.core.errors import ImpossibleEvidenceError
from bayeshunt.models.body.inverse import InverseModel

pytestmark = pytest.mark.slow

NETWORKS, QUESTIONS = 1000, 20


class PyAgrum:
    """The network in pyAgrum, from the tables alone."""

    def __init__(self, gum, model):
        self.net = gum.BayesNet()
        for name in ("Gait", "Distance", "Angle", "Heading"):
            size = len(model.probabilities(name))
            self.net.add(gum.LabelizedVariable(name, name, [f"s{i}" for i in range(size)]))
        for name in ("Distance", "Angle", "Heading"):
            self.net.addArc("Gait", name)
            for gait, column in enumerate(model.probabilities(name).T):
                self.net.cpt(name)[{"Gait": gait}] = column.tolist()
        self.net.cpt("Gait").fillWith(model.probabilities("Gait").tolist())
        self.engine = gum.LazyPropagation(self.net)

    def ask(self, bins):
        self.engine.setEvidence(bins)
        self.engine.makeInference()
        return self.engine.posterior("Gait").toarray().ravel()


def test_three_engines_agree(figure):
    gum = pytest.importorskip("pyagrum")
    from pgmpy.inference import VariableElimination

    rng, worst, asked, impossible = np.random.default_rng(11), 0.0, 0, 0
    for number in range(NETWORKS):
        model = random_model(1000 + number)
        joint, inverse = full_joint(model), InverseModel(model)
        agrum, pgmpy = PyAgrum(gum, model), VariableElimination(model.network)
        with_heading = joint.sum(axis=0)
        for d, a, h in pick(np.argwhere(with_heading > 0), rng):
            heading = h if asked % 2 else None
            answer = ask(inverse, d, a, heading)
            bins = {"Distance": d, "Angle": a, **({} if heading is None else {"Heading": h})}
            theirs = pgmpy.query(["Gait"], evidence=answer.evidence, show_progress=False)
            named = np.array([theirs.get_value(Gait=name) for name in model.gaits.names])
            worst = max(worst, np.abs(answer.values - named).max(), np.abs(answer.values - agrum.ask(bins)).max())
            asked += 1
        for d, a, h in pick(np.argwhere(with_heading == 0), rng):
            with pytest.raises(ImpossibleEvidenceError):
                ask(inverse, d, a, h)
            impossible += 1
    assert worst < 1e-12
    assert asked == NETWORKS * QUESTIONS
    assert impossible > 5000
    figure(
        f"a. {NETWORKS} random networks, {asked} questions: largest difference {worst:.1e}; "
        f"{impossible} questions with impossible evidence: the typed error in every case"
    )


def pick(cells, rng):
    return cells[rng.integers(0, len(cells), QUESTIONS)].tolist() if len(cells) else []


def ask(inverse, d, a, h):
    """The answer at the centre of a cell, or the refusal."""
    distance, angle, heading = (axis.centres for axis in inverse.model.axes)
    return inverse.posterior(distance[d], angle[a], None if h is None else heading[h], snap=False)
