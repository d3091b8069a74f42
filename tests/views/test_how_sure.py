"""How sure an answer is, beside every probability: card, text, terminal and JSON."""

import json
import math

import pytest
from typer.testing import CliRunner

import bayeshunt as bh
from bayeshunt.cli import app
from bayeshunt.views.sheets.sheet import Bars, bounds


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
    assert answer._repr_html_().count('class="bh-whisker"') == len(answer.values)


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
