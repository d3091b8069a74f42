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


def test_what_each_coordinate_answers_before_and_after():
    one = fitted(prior=0.1)
    assert not bh.compare(one, one).answers["changed"].any()
    rows = babbled(600, 1)
    first, second = repertoire().names[:2]
    swapped = rows.assign(gait=rows["gait"].replace({first: second, second: first}))
    two = bh.ForwardModel.fit(swapped, repertoire(), 0.1)
    answers = bh.compare(one, two).answers
    for place in answers.to_dict("records"):
        at = (place["distance"], place["angle"])
        assert place["before"] == bh.InverseModel(one).posterior(*at).best
        assert place["after"] == bh.InverseModel(two).posterior(*at).best
    assert answers["changed"].any()


def test_a_comparison_and_a_learning_become_pages(tmp_path):
    found = bh.compare(fitted(seed=1), fitted(seed=5, noise=0.4))
    learning = bh.Learning(babbled(120, 2), repertoire(), 0.1)
    for thing, name in ((found, "compare.html"), (learning, "learning.html")):
        thing.save(tmp_path / name)
        html = (tmp_path / name).read_text(encoding="utf-8")
        assert "default-src 'none'" in html.replace("&#39;", "'")
        assert "http://" not in html.replace("http://www.w3.org/", "")
        assert str(thing).splitlines()[0] in html or name == "learning.html"
    with pytest.raises(InputError, match=r"name it .*\.html"):
        learning.save(tmp_path / "learning.csv")


def test_intervals_shrink_as_rows_come():
    learning = bh.Learning(babbled(400, 2), repertoire(), 0.1)
    widths = learning.widths([40, 100, 400])["width"].to_numpy()
    assert (np.diff(widths) < 0).all()
    table = learning.model(40).table("Distance")
    held = table.count.to_numpy() > 0
    spans = [
        (t.high - t.low).to_numpy()[t.count.to_numpy() > 0]
        for t in (learning.model(40).table(v) for v in ("Distance", "Angle", "Heading"))
    ]
    assert held.any()
    assert widths[0] == pytest.approx(np.concatenate(spans).mean())


def test_the_cells_of_rows_count_to_the_model():
    learning = bh.Learning(babbled(200, 2), repertoire(), 0.1)
    cells, axes = learning.cells(150)
    assert len(cells) == 150
    counts = np.zeros((axes.angle.bins, len(repertoire())), dtype=int)
    np.add.at(counts, (cells[:, 2], cells[:, 0]), 1)
    np.testing.assert_array_equal(counts, learning.model(150).counts("Angle"))
