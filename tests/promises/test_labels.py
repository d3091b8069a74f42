"""Save, reload, export, re-import: the same posterior whatever the gaits are called."""

import json

import numpy as np
import pytest
from model_cases import WHEELS, babbled

from bayeshunt.core.gaits import Gait, GaitRepertoire
from bayeshunt.data import babbling_table
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.models.body.inverse import InverseModel

pytestmark = pytest.mark.slow

STYLES = {
    "integers": ["1", "2", "10", "01", "0"],
    "negatives": ["-1", "+1", "1", "-10", "--1"],
    "intervals": ["(0.1, 0.2]", "[0.1, 0.2)", "(0.1; 0.2)", "<0.1", ">=0.2"],
    "spaces": ["a b", "a  b", " a b", "a b ", "a\tb"],
    "unicode": ["höger", "ho\u0308ger", "右", "→", "🐁"],
    "quotes": ["'a'", '"a"', "`a`", '<a b="c">&amp;</a>', "a\\'b"],
    "very long": [letter * 5000 for letter in "abcd"] + ["a" * 4999 + "b"],
}


def fitted(names, tmp_path):
    """A model of five gaits with these names, by way of a file."""
    frame = babbled(400, 3)
    frame["gait"] = frame["gait"].map(dict(zip(WHEELS, names, strict=True)))
    babbling_table.save(frame, tmp_path / "b.parquet")
    chosen = tuple(Gait(n, w) for n, w in zip(names, WHEELS.values(), strict=True))
    gaits = GaitRepertoire(chosen, body_length=0.057, duration=3.328)
    return ForwardModel.fit(babbling_table.load(tmp_path / "b.parquet"), gaits, prior=0.3)


def in_pgmpy(path, evidence):
    from pgmpy.inference import VariableElimination
    from pgmpy.readwrite import XMLBIFReader

    asked = VariableElimination(XMLBIFReader(str(path)).get_model()).query(["Gait"], evidence, show_progress=False)
    return {state: asked.get_value(Gait=state) for state in asked.state_names["Gait"]}


def in_pyagrum(path, evidence):
    gum = pytest.importorskip("pyagrum")
    net = gum.loadBN(str(path.rename(path.with_suffix(".bifxml"))))  # it goes by the name's ending
    asked = gum.getPosterior(net, target="Gait", evs=evidence)
    return dict(zip(net.variable("Gait").labels(), asked.toarray(), strict=True))


@pytest.mark.parametrize("style", STYLES)
def test_the_same_posterior(style, tmp_path, figure):
    names = STYLES[style]
    model = fitted(names, tmp_path)
    answer = InverseModel(model).posterior(0.15, 0.3, 0.4, snap=False)
    assert list(answer.probabilities.index) == names
    model.save(tmp_path / "m.json")
    again = ForwardModel.load(tmp_path / "m.json")
    assert again == model
    np.testing.assert_array_equal(InverseModel(again).posterior(0.15, 0.3, 0.4, snap=False).values, answer.values)
    again.to_xmlbif(tmp_path / "m.xmlbif")
    labels = json.loads((tmp_path / "m.xmlbif.labels.json").read_text(encoding="utf-8"))
    evidence = {v: next(s for s, label in labels[v].items() if label == value) for v, value in answer.evidence.items()}
    worst = 0.0
    for engine in (in_pgmpy, in_pyagrum):
        theirs = engine(tmp_path / "m.xmlbif", evidence)
        named = {labels["Gait"][state]: value for state, value in theirs.items()}
        assert set(named) == set(names)
        worst = max(worst, *(abs(named[n] - p) for n, p in answer.probabilities.items()))
    assert worst < 1e-12
    figure(f"g. {style}: saved, reloaded, exported, re-imported by pgmpy and pyAgrum: largest difference {worst:.1e}")
