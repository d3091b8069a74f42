"""The XMLBIF export, read back by pgmpy and by pyAgrum."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from bayeshunt.core.bins import EffectAxes
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.models.body.inverse import InverseModel
from bayeshunt.models.formats import interchange, xmlbif

gum = pytest.importorskip("pyagrum")

TARGETS = [(0.15, 0.3), (0.19, 0.0), (0.03, 2.0), (0.5, -1.0)]


@pytest.fixture
def exported(model: ForwardModel, tmp_path: Path) -> Path:
    model.to_xmlbif(tmp_path / "model.bifxml")
    return tmp_path / "model.bifxml"


def safe(model: ForwardModel, evidence: dict[str, str]) -> dict[str, str]:
    """Evidence in the labels of the export."""
    maps = {v: {label: name for name, label in names.items()} for v, names in xmlbif.safe_labels(model).items()}
    return {variable: maps[variable][label] for variable, label in evidence.items()}


def test_labels_are_safe_unique_and_mapped(model: ForwardModel, exported: Path) -> None:
    labels = json.loads(xmlbif.labels_path(exported).read_text())
    assert list(labels["Gait"].values()) == list(model.gaits.names)
    assert list(labels["Angle"].values()) == list(model.axes.angle.labels)
    for names in labels.values():
        assert len(set(names)) == len(names)
        assert all(name.isidentifier() and name.isascii() and name[0].isalpha() for name in names)


def test_pgmpy_reads_the_same_posterior(model: ForwardModel, inverse: InverseModel, exported: Path) -> None:
    from pgmpy.inference import VariableElimination
    from pgmpy.readwrite import XMLBIFReader

    network = XMLBIFReader(str(exported)).get_model()
    names = list(xmlbif.safe_labels(model)["Gait"])
    for target in TARGETS:
        answer = inverse.posterior(*target)
        evidence = safe(model, answer.evidence)
        read = VariableElimination(network).query(["Gait"], evidence=evidence, show_progress=False)
        values = [read.get_value(Gait=name) for name in names]
        np.testing.assert_allclose(values, answer.values, rtol=0, atol=1e-12)


def test_pyagrum_reads_the_same_posterior(model: ForwardModel, inverse: InverseModel, exported: Path) -> None:
    network = gum.loadBN(str(exported))
    order = [network.variable("Gait").index(name) for name in xmlbif.safe_labels(model)["Gait"]]
    for target in TARGETS:
        answer = inverse.posterior(*target, 0.1)
        engine = gum.LazyPropagation(network)
        engine.setEvidence(safe(model, answer.evidence))
        engine.makeInference()
        values = engine.posterior("Gait").toarray()[order]
        np.testing.assert_allclose(values, answer.values, rtol=0, atol=1e-12)


def test_tables_are_exact(model: ForwardModel, exported: Path) -> None:
    from pgmpy.readwrite import XMLBIFReader

    network = XMLBIFReader(str(exported)).get_model()
    for effect in ("Distance", "Angle", "Heading"):
        assert np.array_equal(network.get_cpds(effect).get_values(), model.probabilities(effect))


def test_labels_read_like_the_states_they_stand_for() -> None:
    gaits = ["wide right", "wide-right", "wide_right_2", "3", "", "\u00e9tir\u00e9 (slow)", "\u524d"]
    names = dict(xmlbif.safe_labels(ForwardModel.empty(gaits, 1.0, axes=EffectAxes.standard(0.05)))["Gait"])
    assert names == {
        "wide_right": "wide right", "wide_right_2": "wide-right", "wide_right_2_2": "wide_right_2", "gait_3": "3",
        "gait": "", "etire_slow": "\u00e9tir\u00e9 (slow)", "gait_2": "\u524d",
    }  # fmt: skip
    axes = EffectAxes.standard(0.057, angle_bins=16).extended(30)
    bins = xmlbif.safe_labels(ForwardModel.empty(["go"], 1.0, axes=axes))
    assert list(bins["Distance"])[27:29] == ["mm153p9_159p6", "mm159p6_165p3"]
    assert list(bins["Angle"])[6:10] == ["deg_minus45", "deg_minus22p5", "deg0", "deg22p5"]


def test_an_earlier_export_still_comes_in(model: ForwardModel, exported: Path) -> None:
    """Its states were called g0, d00, a00, h00."""
    text, labels = exported.read_text(), json.loads(xmlbif.labels_path(exported).read_text())
    earlier: dict[str, dict[str, str]] = {}
    for variable, names in labels.items():
        earlier[variable] = {f"{variable[0].lower()}{i:02d}": label for i, label in enumerate(names.values())}
        head, rest = text.split(f"<NAME>{variable}</NAME>", 1)
        mine, after = rest.split("</VARIABLE>", 1)
        for old, new in zip(names, earlier[variable], strict=True):
            mine = mine.replace(f"<OUTCOME>{old}</OUTCOME>", f"<OUTCOME>{new}</OUTCOME>")
        text = f"{head}<NAME>{variable}</NAME>{mine}</VARIABLE>{after}"
    exported.write_text(text)
    xmlbif.labels_path(exported).write_text(json.dumps(earlier))
    imported = interchange.read_network(exported, gaits=model.gaits)
    for variable in ("Gait", "Distance", "Angle", "Heading"):
        assert list(imported.cpt(variable).index) == list(model.cpt(variable).index)
        np.testing.assert_allclose(imported.probabilities(variable), model.probabilities(variable), rtol=0, atol=1e-15)
