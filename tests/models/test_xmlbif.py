"""The XMLBIF export, read back by pgmpy and by pyAgrum."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.models.body.inverse import InverseModel
from bayeshunt.models.formats import xmlbif

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
        assert all(name.isalnum() and name[0].isalpha() for name in names)
        assert list(names) == sorted(names)


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
