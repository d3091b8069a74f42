"""Pseudo-counts of any size: right, or refused before anything is written."""

from __future__ import annotations

import json

import numpy as np
import pandas as pd
import pytest

import bayeshunt as bh
from bayeshunt.core.checks import LEAST_PSEUDO_COUNT, MOST_PSEUDO_COUNT
from bayeshunt.models.counting.joint import JointCounts

GAITS = ("go", "turn")
AXES = bh.EffectAxes.standard(0.05, distance_bin=1.0, angle_bins=4, heading_bins=4)
#: go always ends in one cell, turn in another; each cell differs in all three effects.
ROWS = pd.DataFrame(
    {
        "gait": ["go"] * 4 + ["turn"] * 4,
        "distance": [0.02] * 4 + [0.07] * 4,
        "angle": [0.0] * 4 + [np.pi / 2] * 4,
        "heading": [0.0] * 4 + [np.pi / 2] * 4,
        "previous_gait": ["go", "turn"] * 4,
    }
)
STRUCTURES = ("naive", "joint", "previous_gait")
STRANGE = (1e308, 1.1 * MOST_PSEUDO_COUNT, 0.9 * LEAST_PSEUDO_COUNT, 1e-200, 5e-324, -1e-9, np.nan, np.inf, True, "1")


@pytest.mark.parametrize("structure", STRUCTURES)
@pytest.mark.parametrize("gait_prior", ["uniform", "empirical"])
@pytest.mark.parametrize("prior", [LEAST_PSEUDO_COUNT, 1e-20, 0.5, MOST_PSEUDO_COUNT])
def test_every_prior_that_is_taken_gives_the_right_answer(prior: float, gait_prior: str, structure: str) -> None:
    model = bh.ForwardModel.fit(ROWS, GAITS, prior, axes=AXES, gait_prior=gait_prior, structure=structure)
    for variable in ("Gait", "Distance", "Angle", "Heading"):
        table = model.probabilities(variable)
        assert np.isfinite(table).all()
        assert (table > 0).all()
        np.testing.assert_allclose(table.sum(axis=0), 1.0, rtol=1e-12)
    answer = bh.InverseModel(model).posterior(0.02, 0.0, 0.0)
    other = model.evidence(0, 2, 2)
    assert (other > 0).all()
    np.testing.assert_allclose(answer.values, other / other.sum(), rtol=1e-12)
    if structure == "naive" and gait_prior == "uniform":
        likely, rare = ((4 + prior) / (4 + k * prior) for k in (2, 4)), (prior / (4 + k * prior) for k in (2, 4))
        odds = [distance * effect**2 for distance, effect in (likely, rare)]
        np.testing.assert_allclose(answer.values, np.array(odds) / sum(odds), rtol=1e-12)
    assert np.isfinite(model.log_likelihood(ROWS))


@pytest.mark.parametrize("prior", STRANGE)
def test_others_are_refused(prior: object) -> None:
    counts = JointCounts.of(ROWS, bh.GaitRepertoire.of(GAITS), AXES)
    for make in (
        lambda: bh.ForwardModel.fit(ROWS, GAITS, prior, axes=AXES),
        lambda: bh.ForwardModel.fit(ROWS, GAITS, prior, axes=AXES, structure="previous_gait"),
        lambda: bh.ForwardModel.from_counts(counts, prior),
        lambda: bh.ForwardModel.empty(GAITS, prior, axes=AXES),
        lambda: bh.ForwardModel(counts, prior),
        lambda: bh.assess(ROWS, GAITS, prior=prior, axes=AXES, folds=2, permutations=1),
    ):
        with pytest.raises(bh.InputError, match=r"^prior\b"):
            make()


def test_a_file_with_such_a_prior_is_malformed(tmp_path) -> None:
    from bayeshunt.models.formats.model_file import _checksum

    bh.ForwardModel.fit(ROWS, GAITS, 0.5, axes=AXES).save(tmp_path / "m.json")
    record = json.loads((tmp_path / "m.json").read_text())
    for prior in (1e308, 1e-200, -1, True, None):
        record["content"]["prior"] = prior
        record["checksum"] = _checksum(record["content"])
        (tmp_path / "m.json").write_text(json.dumps(record))
        with pytest.raises(bh.ModelFileError, match=r"m\.json: malformed content \(InputError: prior is "):
            bh.ForwardModel.load(tmp_path / "m.json")


@pytest.mark.parametrize("prior", ["1e308", "1e-200"])
def test_fit_writes_no_broken_model(prior: str, tmp_path, bayeshunt) -> None:
    bh.save_dataset(bh.babble("khepera", 60, 0), tmp_path / "b.parquet")
    _, err = bayeshunt("fit", "b.parquet", "--prior", prior, "--out", "m.json", status=2)
    said = "expected 0, or a pseudo-count from 1e-50 to 1e+09"
    assert said in " ".join(err.split())
    assert not (tmp_path / "m.json").exists()
