"""How sure an answer is, beside every probability: card, text, terminal and JSON."""

import copy
import dataclasses
import json
import math

import numpy as np
import pytest
from typer.testing import CliRunner

import bayeshunt as bh
from bayeshunt.cli import app
from bayeshunt.core.units import bounds
from bayeshunt.views.sheets.sheet import Bars
from bayeshunt.views.terminal.terminal import episode_table


@pytest.fixture(scope="module")
def model():
    table = bh.load_dataset("data/khepera_babbling.parquet")
    return bh.ForwardModel.fit(table, bh.load_robot("khepera").gaits)


@pytest.fixture(scope="module")
def answer(model):
    return bh.InverseModel(model).posterior(0.168, math.radians(-20))


@pytest.mark.parametrize(
    ("low", "high", "words"),
    [(0.2437, 1.0, "0.24 to 1"), (0.9958, 0.9999, "0.99 to 1"), (0.0, 1e-30, "0 to 0"), (0.3, 0.5, "0.3 to 0.5")],
)
def test_bounds_are_rounded_outwards(low, high, words):
    assert bounds(low, high) == words


def test_text_and_card_show_the_interval(answer):
    low = answer.interval().loc[answer.best, "low"]
    said = f"1.0000 ({math.floor(100 * low) / 100:g} to 1)"
    assert low < 0.5
    for shown in (str(answer), answer._repr_html_()):
        assert said in shown
        assert "one row: not sure" in shown
    html = answer._repr_html_()
    assert html.count('class="bh-whisker"') == len(answer.values)
    drawn = html.split("The network given this evidence")[1].split("</details>")[0]
    assert drawn.count('stroke-width="1.6"') == 2 * len(answer.values)  # beside, and stacked for phones


def test_the_shortest_form_shows_it_too(answer):
    low = answer.interval().loc[answer.best, "low"]
    assert f"{answer.best} 1.000 ({math.floor(100 * low) / 100:g} to 1)" in repr(answer)
    assert repr(answer).endswith("1 row>")


@pytest.mark.parametrize("planner", ["reactive", "prediction"])
def test_a_decision_shows_it(model, planner):
    """Of the answer that the plan carries; where it came from another process, as its trace has it."""
    asked = bh.make_planner(planner, model)
    episode = bh.hunt("paper", asked, seed=3)
    again = dataclasses.replace(episode.situations[1], interval=0.5)
    plans = [episode.plans[1], asked.plan(again, rng=np.random.default_rng(0))]
    wide, narrow = plans[0].answer.interval(), plans[1].answer.interval(0.5)
    assert wide["low"][plans[0].gait] < narrow["low"][plans[0].gait]
    for plan, ends in ((plans[0], wide), (plans[1], narrow), (copy.deepcopy(plans[1]), narrow)):
        said = f"{plan.value:.4f} ({bounds(*ends.loc[plan.gait, ['low', 'high']])})"
        for shown in (str(plan), plan._repr_html_()):
            assert said in shown
        assert plan._repr_html_().count('class="bh-whisker"') == len(model.gaits)
    assert 'class="bh-whisker"' not in copy.deepcopy(plans[0])._repr_html_()


def test_the_decisions_of_a_hunt_show_it(model, tmp_path, capsys):
    """In the card, in the text and in the terminal; of a hunt read from a file as it keeps it; none of sequences."""
    hunt = bh.hunt("paper", bh.make_planner("reactive", model), seed=3)
    hunt.save(tmp_path / "hunt.parquet")
    ends = [bounds(*plan.answer.interval().loc[plan.gait, ["low", "high"]]) for plan in hunt.plans]
    said = [f"{plan.value:.3g} ({within})" for plan, within in zip(hunt.plans, ends, strict=True)]
    for episode in (hunt, bh.Episode.load(tmp_path / "hunt.parquet")):
        episode_table(episode)
        for shown in (str(episode), episode._repr_html_(), capsys.readouterr().out):
            for value in set(said):
                assert shown.count(value) == said.count(value)
    planned = bh.hunt("paper", bh.make_planner("planning", model), seed=3)
    assert "95 %" not in str(planned)


def test_without_intervals_there_are_no_whiskers():
    bars = Bars({"a": 0.7, "b": 0.3})
    assert "bh-whisker" not in bars.html()
    assert bars.lines()[0].endswith("0.7000")


def test_query_shows_it_and_gives_it_as_json(model, answer, tmp_path):
    model.save(tmp_path / "m.json")
    model.to_xmlbif(tmp_path / "m.xmlbif")
    asked = ["--distance", "0.168", "--angle", str(math.radians(-20))]
    found = answer.interval()
    text = CliRunner().invoke(app, ["query", str(tmp_path / "m.json"), *asked]).output
    assert f"1.000 ({math.floor(100 * found['low'][answer.best]) / 100:g} to 1)" in text
    assert "one row: not sure" in text
    facts = json.loads(CliRunner().invoke(app, ["query", str(tmp_path / "m.json"), *asked, "--json"]).output)
    assert facts["interval"]["level"] == 0.95
    for end in ("low", "median", "high"):
        assert facts["interval"][end] == pytest.approx(found[end].to_dict())
    imported = json.loads(CliRunner().invoke(app, ["query", str(tmp_path / "m.xmlbif"), *asked, "--json"]).output)
    assert imported["interval"] is None


def test_the_cell_that_matters_most_is_drawn_first_and_opens_its_rows(khepera_frame):
    model = bh.ForwardModel.fit(khepera_frame, bh.load_robot("khepera").gaits, 0.1)
    answer = next(
        found
        for d, a in model.learned_cells.tolist()
        if (found := bh.InverseModel(model).posterior(model.axes.distance.centres[d], model.axes.angle.centres[a]))
        and found.sensitivity()["effect"].iloc[0] > 0.01
        and found.sensitivity()["count"].iloc[0] > 0
    )
    html = answer._repr_html_()
    first = answer.sensitivity().iloc[0]
    part = html.split("Which cell matters most")[1]
    ends = sorted((first["best_at_low"], first["best_at_high"]))
    assert f"{ends[0]:.3f} to {ends[1]:.3f}, {first['count']} rows" in part.split("</summary>")[1]
    rows = model.rows(first["variable"], first["state"], first["gait"])
    assert f">{rows.index[0]}</th>" in part.split("</details>")[0]
    assert f"Where P({answer.best}) comes from" in html
    assert bh.trace(answer).formula.split(" = ")[1][:8] in html.split("comes from")[1]


def test_a_gait_with_a_comma_in_its_name_opens_its_rows(khepera_frame, khepera_model):
    shipped = bh.load_robot("khepera").gaits
    named = {gait.name: f"{gait.name}, Gait = fast" for gait in shipped}
    gaits = dataclasses.replace(shipped, gaits=tuple(bh.Gait(named[gait.name], gait.command) for gait in shipped))
    frame = khepera_frame.assign(gait=khepera_frame["gait"].map(named))
    model = bh.ForwardModel.fit(frame, gaits, 0.1)
    answer = bh.InverseModel(model).posterior(0.16, -0.35)
    first = answer.sensitivity().iloc[0]
    opened = answer._repr_html_().split("Which cell matters most")[1].split("</details>")[0]
    rows = model.rows(first["variable"], first["state"], first["gait"])
    assert "holds no rows" not in opened
    assert (f">{rows.index[0]}</th>" if len(rows) else "No row fell into this cell.") in opened
    first_of_all = bh.hunt("paper", bh.make_planner("planning", khepera_model), seed=3).situations[0]
    plan = bh.make_planner("planning", model).plan(first_of_all, rng=np.random.default_rng(0))
    found = bh.trace(plan, model=model)
    assert set(found.cells["gait"]) == set(plan.gaits)
    assert plan.gait in str(found)
