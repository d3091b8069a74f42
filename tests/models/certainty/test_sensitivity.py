"""Which cell an answer hangs on: by moving the cell in the tables by hand."""

import numpy as np
import pytest
from model_cases import babbled, repertoire, small_axes

import bayeshunt as bh


def fitted(structure, prior):
    rows = babbled(120, seed=4)
    rows["previous_gait"] = rows["gait"].shift(1)
    return bh.ForwardModel.fit(rows, repertoire(), prior, axes=small_axes(3, 4, 4), structure=structure)


@pytest.mark.parametrize("prior", [0.0, 0.5])
def test_each_cell_moved_by_hand(prior):
    model = fitted("naive", prior)
    answer = bh.InverseModel(model).posterior(0.15, 0.4)
    found = answer.sensitivity()
    assert list(found["effect"]) == sorted(found["effect"], reverse=True)
    assert len(found) == 2 * len(model.gaits)
    tables = {v: model.cpt(v).loc[answer.evidence[v]] for v in ("Distance", "Angle")}
    for row in found.to_dict("records"):
        gait, variable = row["gait"], row["variable"]
        assert row["given"] == f"Gait = {gait}"
        assert row["state"] == answer.evidence[variable]
        assert row["count"] == model.counts(variable).loc[row["state"], gait]
        assert row["count"] == len(model.rows(variable, row["state"], gait))
        low, high = model.credible_interval(variable)
        for end, bound in (("low", low), ("high", high)):
            assert row[end] == pytest.approx(bound.loc[row["state"], gait], abs=1e-12)
            moved = {v: table.copy() for v, table in tables.items()}
            moved[variable][gait] = row[end]
            joint = moved["Distance"] * moved["Angle"]
            expected = joint[answer.best] / joint.sum() if joint.sum() else np.nan
            assert row[f"best_at_{end}"] == pytest.approx(expected, abs=1e-12, nan_ok=True)


@pytest.mark.parametrize("structure", ["tan", "joint", "previous_gait"])
def test_every_cell_of_any_structure_holds_the_best_between_its_ends(structure):
    answer = bh.InverseModel(fitted(structure, 0.3)).posterior(0.15, 0.4)
    found = answer.sensitivity()
    best, ends = answer.values.max(), found[["best_at_low", "best_at_high"]]
    assert (ends.min(axis=1) <= best + 1e-9).all()
    assert (ends.max(axis=1) >= best - 1e-9).all()
    assert found["effect"].iloc[0] > 0


def test_the_gait_of_a_cell_is_its_own_whatever_the_table():
    rows = babbled(120, seed=4)
    rows["previous_gait"] = rows["gait"].shift(1)
    axes, known = small_axes(3, 4, 4), {"gait_prior": "empirical", "structure": "previous_gait"}
    model = bh.ForwardModel.fit(rows, repertoire(), 0.3, axes=axes, **known)
    found = bh.InverseModel(model).posterior(0.15, 0.4).sensitivity()
    of = dict(iter(found.groupby("variable")))
    assert list(of["Gait"]["gait"]) == list(of["Gait"]["state"])
    assert of["PreviousGait"]["gait"].isna().all()
    for row in of["Angle"].to_dict("records"):
        assert f"Gait = {row['gait']}" in row["given"].split(", ")
