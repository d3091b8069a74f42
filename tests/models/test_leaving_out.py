"""From rows to cells and back: what a row is counted in, and the model without it."""

import numpy as np
import pandas as pd
import pytest
from model_cases import babbled, repertoire

import bayeshunt as bh
from bayeshunt.core.errors import DataError, InputError

STRUCTURES = ("naive", "joint", "previous_gait")


def rows_of():
    rows = babbled(300, seed=4)
    rows["previous_gait"] = rows["gait"].shift(1)
    return rows


def fitted(rows, structure="naive", prior=0.2, **options):
    return bh.ForwardModel.fit(rows, repertoire(), prior, structure=structure, **options)


@pytest.mark.parametrize("structure", STRUCTURES)
def test_without_equals_a_refit(structure):
    rows = rows_of()
    model = fitted(rows, structure)
    farthest = rows["distance"].idxmax()
    for left_out in ([17], [farthest, 5, 200], list(range(50, 90))):
        expected = fitted(rows.drop(left_out), structure)
        for given in (left_out, rows.loc[left_out]):
            found = model.without(given)
            assert found == expected
            for name, table in expected.local_tables.items():
                np.testing.assert_allclose(found.local_tables[name], table, atol=1e-12)


def test_bins_that_were_given_stay():
    rows = rows_of()
    axes = bh.EffectAxes.standard(0.057).extended(60)
    assert fitted(rows, axes=axes).without([3]) == fitted(rows.drop([3]), axes=axes)


def test_without_the_rows_behind_a_cell_it_is_empty():
    model = fitted(rows_of())
    label = model.counts("Distance")["slow"].idxmax()
    behind = model.rows("Distance", label, "slow")
    assert model.without(behind).counts("Distance").loc[label, "slow"] == 0


@pytest.mark.parametrize("structure", STRUCTURES)
def test_a_row_is_among_the_rows_of_each_cell_that_uses_it(structure):
    rows = rows_of()
    model = fitted(rows, structure)
    for label in (1, 40, 299):
        used = model.uses(label).set_index("variable")
        assert list(used.index) == list(model.local_tables)
        assert used.loc["Gait", "state"] == rows.loc[label, "gait"]
        assert (used["count"] >= 1).all()
        for effect in ("Distance", "Angle", "Heading"):
            assert label in model.rows(effect, used.loc[effect, "state"], rows.loc[label, "gait"]).index
        pd.testing.assert_frame_equal(model.uses(rows.loc[label]), model.uses(label))
    if structure == "naive":
        state = used.loc["Angle", "state"]
        assert used.loc["Angle", "count"] == len(model.rows("Angle", state, rows.loc[label, "gait"]))
        assert used.loc["Angle", "probability"] == model.cpt("Angle").loc[state, rows.loc[label, "gait"]]


@pytest.mark.parametrize(
    "ask",
    [
        lambda m, r: m.without([100_000]),
        lambda m, r: m.without(r.head(2).assign(distance=9.0)),
        lambda m, r: m.uses(100_000),
        lambda m, r: m.uses(r.head(2)),
    ],
)
def test_rows_that_were_never_counted_are_refused(ask):
    rows = rows_of()
    with pytest.raises(InputError):
        ask(fitted(rows), rows)


def test_a_model_without_rows_says_so(tmp_path):
    fitted(rows_of()).save(tmp_path / "m.json")
    with pytest.raises(DataError, match="with_data"):
        bh.ForwardModel.load(tmp_path / "m.json").without([1])
    with pytest.raises(InputError, match="part"):
        fitted(rows_of(), "previous_gait").after("slow").without([1])
