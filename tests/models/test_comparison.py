"""Two models side by side, and one that learns row by row."""

import numpy as np
import pandas as pd
import pytest
from model_cases import babbled, repertoire, small_axes
from scipy.stats import entropy

import bayeshunt as bh
from bayeshunt.core.errors import DataError, InputError


def fitted(rows=600, seed=1, noise=0.08, prior=0.0, **options):
    return bh.ForwardModel.fit(babbled(rows, seed, noise=noise), repertoire(), prior, **options)


@pytest.mark.parametrize("prior", [0.0, 0.5])
def test_a_model_does_not_differ_from_itself(prior):
    model = fitted(prior=prior)
    found = bh.compare(model, model)
    assert found.cells.empty
    assert all((frame.to_numpy() == 0).all() for frame in found.difference.values())
    assert (found.edges_added, found.edges_removed) == ((), ())
    assert "0 of" in repr(found)


@pytest.mark.parametrize("prior", [0.0, 0.5])
def test_two_babblings_of_one_robot_differ_in_few_cells(prior):
    assert bh.compare(fitted(seed=1, prior=prior), fitted(seed=2, prior=prior)).share <= 0.05


def test_a_worn_robot_differs_where_it_is_worn():
    rows = babbled(600, 1)
    worn = rows.assign(distance=np.where(rows["gait"] == "straight", 0.5 * rows["distance"], rows["distance"]))
    one, two = (bh.ForwardModel.fit(r, repertoire(), 0.1) for r in (rows, worn))
    found = bh.compare(one, two)
    assert set(found.cells["gait"]) == {"straight"}
    assert set(found.cells["variable"]) == {"Distance"}
    top = found.cells.iloc[0]
    before, after = (model.cpt("Distance")["straight"].get(top["state"], 0.0) for model in (one, two))
    assert top["difference"] == pytest.approx(after - before)
    assert top["low"] * top["high"] > 0
    for shown in (str(found), found._repr_html_()):
        assert "straight" in shown


def test_edges_and_what_is_refused():
    found = bh.compare(fitted(), fitted(prior=0.3, structure="joint"))
    assert ("Distance", "Angle") in found.edges_added
    assert found.edges_removed == ()
    with pytest.raises(InputError, match="bins"):
        bh.compare(fitted(), fitted(axes=small_axes(3)))
    with pytest.raises(InputError, match="ForwardModel"):
        bh.compare(fitted(), "b")


@pytest.mark.parametrize("prior", [None, 0.4])
def test_the_model_at_a_row_is_the_fit_of_the_rows_before(prior):
    rows = babbled(200, 3)
    learning = bh.Learning(rows, repertoire(), prior)
    for n in (40, 111, 200):
        expected = bh.ForwardModel.fit(rows[:n], repertoire(), prior)
        found = learning.model(n)
        assert found == expected
        for name, table in expected.local_tables.items():
            assert np.array_equal(found.local_tables[name], table)
    with pytest.raises(InputError):
        learning.model(201)
    if prior is None:
        with pytest.raises(DataError):
            learning.model(2)


def test_more_rows_foretell_better_and_reach_farther():
    learning = bh.Learning(babbled(600, 3), repertoire())
    loss, reached = learning.log_loss([20, 480]), learning.coverage([20, 600])
    assert loss["log_loss"].iloc[1] < loss["log_loss"].iloc[0]
    assert reached["coordinates"].iloc[1] > reached["coordinates"].iloc[0]
    assert reached["gaits"].iloc[1] == 5
    assert len(learning.coverage()) > 5


def test_what_to_babble_next_as_by_drawing_the_tables():
    rows = babbled(60, 3)
    rows = rows.drop(rows.index[rows["gait"] == "slow"][3:])
    learning = bh.Learning(rows, repertoire(), 0.5, axes=small_axes(3, 4, 4))
    found, rng = learning.babble_next(), np.random.default_rng(0)
    model = learning.model(len(rows))
    for gait in ("slow", "straight"):
        expected = 0.0
        for effect in ("Distance", "Angle", "Heading"):
            tables = rng.dirichlet(model.counts(effect)[gait] + 0.5, 40_000)
            expected += entropy(model.cpt(effect)[gait], base=2) - entropy(tables, axis=1, base=2).mean()
        assert found[gait] == pytest.approx(expected, rel=0.03)
    assert found.index[0] == "slow"  # the fewest rows
    assert isinstance(found, pd.Series)
