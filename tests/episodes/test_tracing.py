"""Answers and decisions opened: the numbers multiply to the posterior, and the rows are as many as the counts."""

import numpy as np
import pytest

import bayeshunt as bh
from bayeshunt.core.errors import InputError
from bayeshunt.core.units import bounds
from bayeshunt.episodes.considered import first_gaits


@pytest.fixture(scope="module")
def model():
    table = bh.load_dataset("data/khepera_babbling.parquet")
    return bh.ForwardModel.fit(table, bh.load_robot("khepera").gaits)


def as_printed(formula):
    """The factors, P(evidence) and the posterior that a formula prints."""
    product, posterior = formula.split(" = ", 1)[1].split(" = ")
    factors, evidence = product.split(" / ")
    return [float(part) for part in factors.split(" x ")], float(evidence), float(posterior)


def opened_right(found, answer, model):
    factors, evidence, posterior = as_printed(found.formula)
    # six digits are printed of every number, so the quotient holds to one unit in the sixth of each of them
    assert np.prod(factors) / evidence == pytest.approx(posterior, rel=5e-6 * (len(factors) + 2))
    np.testing.assert_allclose(found.factors["posterior"], answer.values, atol=1e-12)
    assert found.factors["product"].sum() == pytest.approx(answer.evidence_probability, rel=1e-9)
    parts = found.factors.drop(columns=["product", "posterior"])
    np.testing.assert_allclose(parts.prod(axis=1), found.factors["product"])
    for cell in found.cells.to_dict("records"):
        assert len(found.rows(cell["variable"])) == cell["count"]
        expected = model.cpt(cell["variable"]).loc[cell["state"]]
        assert cell["probability"] == (expected.iloc[0] if cell["variable"] == "Gait" else expected[found.gait])
    low, high = answer.interval().loc[found.gait, ["low", "high"]]
    for shown in (str(found), found._repr_html_()):
        assert found.gait in shown
        assert bounds(low, high) in shown


@pytest.mark.parametrize("heading", [None, -0.9])
def test_an_answer(model, heading):
    answer = bh.InverseModel(model).posterior(0.16, -0.35, heading)
    for gait in (None, "tight left"):
        found = bh.trace(answer, gait)
        assert found.gait == (gait or answer.best)
        opened_right(found, answer, model)


@pytest.mark.parametrize("planner", ["reactive", "prediction"])
def test_every_decision_of_a_hunt(model, planner):
    episode = bh.hunt("paper", bh.make_planner(planner, model), seed=3)
    assert len(episode.plans)
    for plan, row in zip(episode.plans, episode.frame.to_dict("records"), strict=True):
        found = bh.trace(plan)
        assert found.gait == row["gait"]
        np.testing.assert_allclose(found.factors["posterior"], row["posterior"], atol=1e-12)
        opened_right(found, plan.answer, model)


def test_other_structures_multiply_too():
    table = bh.load_dataset("data/khepera_babbling.parquet")
    model = bh.ForwardModel.fit(table, bh.load_robot("khepera").gaits, 0.1, structure="joint")
    answer = bh.InverseModel(model).posterior(0.16, -0.35)
    np.testing.assert_allclose(bh.trace(answer).factors["posterior"], answer.values, atol=1e-12)


@pytest.mark.parametrize("structure", ["naive", "tan", "previous_gait"])
def test_a_cell_has_the_interval_of_its_table(khepera_frame, structure):
    gaits = bh.load_robot("khepera").gaits
    for prior, gait_prior in ((0.0, "uniform"), (0.3, "empirical")):
        whole = bh.ForwardModel.fit(khepera_frame, gaits, prior, structure=structure, gait_prior=gait_prior)
        model = whole.after(gaits.names[2])
        answer = bh.InverseModel(model).posterior(0.16, -0.35, -0.5)
        for cell in bh.trace(answer).cells.to_dict("records"):
            table = model.table(cell["variable"])
            own = bh.trace(model, cell=(cell["variable"], cell["state"], answer.best))
            if table.low is None:
                assert (np.isnan(cell["low"]), own.within) == (True, None)
                continue
            place = (cell["state"], "low" if cell["variable"] == "Gait" else answer.best)
            low, high = table.low.loc[place], table.high.loc[(place[0], place[1].replace("low", "high"))]
            assert (cell["low"], cell["high"]) == pytest.approx((low, high), rel=1e-12)
            assert own.within == pytest.approx((low, high), rel=1e-12)
            assert f"{low:.3f} to {high:.3f}" in own._repr_html_()


def test_what_cannot_be_traced(model):
    with pytest.raises(InputError, match="answer"):
        bh.trace("x")
    with pytest.raises(InputError, match="no posterior"):
        bh.trace(bh.Plan("straight"))
    with pytest.raises(InputError, match="fly"):
        bh.trace(bh.InverseModel(model).posterior(0.16, -0.35), "fly")


def test_a_cell_of_a_table(model):
    found = bh.trace(model, cell=("Angle", 0.0, "straight"))
    count, total = (model.counts("Angle")["straight"][found.state], model.counts("Angle")["straight"].sum())
    assert (found.count, found.total, found.probability) == (count, total, count / total)
    assert f"({count} + 0) / ({total} + 0 x 36) = {count / total:.6g}" in found.formula
    assert len(found.rows()) == count
    gait = bh.trace(model, cell=("Gait", "straight"))
    assert "1 / 10 = 0.1" in gait.formula
    assert len(gait.rows()) == gait.count
    smoothed = bh.ForwardModel.fit(bh.load_dataset("data/khepera_babbling.parquet"), model.gaits, 0.5)
    told = bh.trace(smoothed, cell=("Angle", found.state, "straight"))
    assert told.probability == pytest.approx((count + 0.5) / (total + 18))
    assert "0.5 x 36" in told.formula
    for shown in (str(found), found._repr_html_()):
        assert "straight" in shown


@pytest.mark.parametrize(
    "cell", [None, ("Height", 0.0, "straight"), ("Angle", "north", "straight"), ("Distance", 9.0, "straight")]
)
def test_what_is_no_cell(model, cell):
    with pytest.raises(InputError, match=r"cell|no bin|outside"):
        bh.trace(model, cell=cell)


def test_a_decision_without_the_rows_behind_it(model):
    """What a decision would rest on had its rows not been babbled: a refit, to the last digits."""
    plan = bh.hunt("paper", bh.make_planner("reactive", model), seed=3).plans[1]
    rows = bh.trace(plan).rows("Angle").index
    left = bh.load_dataset("data/khepera_babbling.parquet").drop(index=rows)
    without, refitted = model.without(rows), bh.ForwardModel.fit(left, model.gaits)
    for variable in ("Distance", "Angle", "Heading", "Gait"):
        both = (m.cpt(variable).reindex(model.cpt(variable).index, fill_value=0.0) for m in (without, refitted))
        np.testing.assert_allclose(*both, atol=1e-12)
    answers = [bh.InverseModel(m).posterior(plan.target.distance, plan.target.angle) for m in (without, refitted)]
    np.testing.assert_allclose(answers[0].values, answers[1].values, atol=1e-12)
    assert answers[0].support == answers[1].support < plan.support or answers[0].cell != plan.answer.cell


@pytest.mark.parametrize(
    "planner", ["planning", "frugal", "intercept", "pure_pursuit", pytest.param("search", marks=pytest.mark.slow)]
)
def test_a_decision_that_weighed_sequences(model, planner):
    episode = bh.hunt("paper", bh.make_planner(planner, model), seed=3)
    for plan in episode.plans[:4]:
        found = bh.trace(plan, model=model)
        assert found.gait == plan.gait
        assert f"{plan.value:.6g}" in found.formula
        assert found.alternatives["least"].min() == pytest.approx(plan.value)
        assert found.alternatives["nodes"].sum() == sum(name is not None for name in first_gaits(plan.trace))
        for cell in found.cells.to_dict("records"):
            gait = cell["given"].removeprefix("Gait = ")
            assert cell["count"] == model.counts(cell["variable"]).loc[cell["state"], gait]
            assert len(found.rows(gait)) == cell["rows"]
        for shown in (str(found), found._repr_html_()):
            assert plan.gait in shown
    with pytest.raises(InputError, match="model=model"):
        bh.trace(plan).rows()
