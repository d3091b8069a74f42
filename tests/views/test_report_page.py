"""The report without a browser: its numbers are the results', its hunts the recorded ones, its size bounded."""

from __future__ import annotations

import re

import numpy as np
import pandas as pd
import pytest

import bayeshunt as bh
from bayeshunt.core.errors import DataError
from bayeshunt.views.pages.report import report_facts, report_html, write_report
from bayeshunt.views.pages.report_charts import styles, time_charts
from bayeshunt.views.pages.report_gallery import choose

SETTINGS = bh.load_experiment("paper", {"protocol.runs": 2})
PLANNERS = ("reactive", "prediction", "planning")


@pytest.fixture(scope="module")
def results(khepera_model):
    return bh.evaluate(SETTINGS, seed=4, model=khepera_model, planners=PLANNERS)


@pytest.fixture(scope="module")
def facts(results, khepera_model):
    return report_facts(results, model=khepera_model, model_path="model.json")


def with_attrs(frame, results):
    frame.attrs = dict(results.attrs)
    return frame


def test_the_table_says_what_summarise_says(facts, results):
    html = report_html(facts)
    for row in bh.summarise(results, SETTINGS):
        if row["theta"] is None:
            cells = f'<td>{row["caught"]} of {row["runs"]}</td><td class="main">{100 * row["success"]:.1f} %</td>'
            assert f'<th scope="row">{row["planner"]}</th><td>{row["arena"]}</td>{cells}' in html
    assert SETTINGS.note in html
    assert "bayeshunt evaluate --preset paper --runs 2 --seed 4 --model model.json --out results" in html


def test_planners_that_know_more_are_marked(results, khepera_model):
    renamed = with_attrs(results.assign(planner=results["planner"].replace("planning", "omniscient")), results)
    html = report_html(report_facts(renamed, model=khepera_model))
    assert '<th scope="row">omniscient *</th>' in html
    assert '<th scope="row">reactive</th>' in html
    (row,) = re.findall(r'<tr><th scope="row">reactive</th><td>open</td>.*?</tr>', html.split('id="bearings"')[0])
    assert "not reported" in row  # the paper has this planner, but not in this arena
    (row,) = re.findall(r'<tr><th scope="row">omniscient \*</th><td>open</td>.*?</tr>', html)
    assert "not reported" not in row  # the paper has no such planner
    assert "* Not ab initio" in html


def test_charts_put_every_value_at_its_height(facts, results):
    rows = {(r["arena"], r["planner"], r["theta"]): r for r in bh.summarise(results, SETTINGS)}
    for chart in facts["success"]:
        height = chart["bottom"] - chart["top"]
        for series in chart["series"]:
            assert len(series["points"]) == 7
            for point, theta in zip(series["points"], SETTINGS.protocol.thetas, strict=True):
                row = rows[chart["arena"], series["planner"], theta]
                for name, value in (("y", "success"), ("low", "ci_low"), ("high", "ci_high")):
                    assert chart["bottom"] - point[name] == pytest.approx(height * row[value], abs=0.051)
    for chart in facts["times"]:
        for series in chart["series"]:
            hunts = results[(results["arena"] == chart["arena"]) & (results["planner"] == series["planner"])]
            points = [tuple(map(float, p.split(","))) for p in series["line"].split()]
            assert points == sorted(points, key=lambda p: (p[0], -p[1]))  # a distribution never falls
            share = (chart["bottom"] - points[-1][1]) / (chart["bottom"] - chart["top"])
            assert share == pytest.approx(hunts["caught"].mean(), abs=1e-3)


def test_the_pace_of_each_planner_is_recomputed(facts, results):
    for row in facts["pace"]:
        hunts = results[(results["arena"] == row["arena"]) & (results["planner"] == row["planner"])]
        caught = hunts[hunts["caught"]]
        if len(caught):
            assert row["quartiles"] == pytest.approx(np.percentile(caught["time"], [25, 50, 75]))
        assert row["distance"] == pytest.approx(sum(hunts["distance"]) / len(hunts))
        assert row["speed"] == pytest.approx(sum(hunts["distance"]) / sum(hunts["time"]))
        assert row["decision_ms"] > 0


def test_the_gallery_holds_the_recorded_hunts(facts, results):
    for shelf in facts["shelves"]:
        assert shelf.problem == ""
        hunts = results[(results["arena"] == shelf.arena) & (results["planner"] == shelf.planner)]
        ends = [True] * int(hunts["caught"].any()) + [False] * int((~hunts["caught"]).any())
        assert [hunt["caught"] for hunt in shelf.hunts] == ends
        for hunt in shelf.hunts:
            (row,) = hunts[hunts["seed"] == int(hunt["seed"])].to_dict("records")
            assert (hunt["theta"], hunt["run"], hunt["caught"]) == (row["theta"], row["run"], row["caught"])
            assert hunt["trail"]["time"][-1] == pytest.approx(row["time"], abs=0.05 if not row["caught"] else 5e-5)


def test_the_median_caught_hunt_and_the_first_miss_are_chosen():
    hunts = pd.DataFrame({"caught": [False, True, True, True, True, False], "time": [60, 9, 7, 8, 30, 60]})
    assert [(row["caught"], row["time"]) for row in choose(hunts)] == [(True, 8), (False, 60)]
    assert choose(hunts[hunts["caught"]])[0]["time"] == 8
    assert [row["time"] for row in choose(hunts[~hunts["caught"]])] == [60]


def test_another_model_is_noticed(results, khepera_frame, tmp_path):
    other = bh.ForwardModel.fit(khepera_frame.iloc[:150], SETTINGS.robot.gaits, prior=0.5)
    warnings = write_report(results, tmp_path / "report.html", model=other)
    assert any("ended otherwise than recorded" in text and "--model" in text for text in warnings)
    assert "ended otherwise than recorded" in (tmp_path / "report.html").read_text()


def test_a_planner_unknown_here_costs_only_its_gallery(results, khepera_model, tmp_path):
    renamed = with_attrs(results.assign(planner=results["planner"].replace("planning", "<b>mine</b>")), results)
    warnings = write_report(renamed, tmp_path / "report.html", model=khepera_model)
    assert len(warnings) == 2
    assert all("unknown planner" in text for text in warnings)
    html = (tmp_path / "report.html").read_text()
    assert "<b>mine</b>" not in html
    assert "&lt;b&gt;mine&lt;/b&gt;" in html


def test_the_model_is_learned_again_from_settings_and_seed(tmp_path):
    small = bh.load_experiment("paper", {"protocol.runs": 1, "model.babbling_steps": 300, "protocol.thetas": [3.0]})
    results = bh.evaluate(small, seed=6, planners=["prediction"])
    assert write_report(results, tmp_path / "report.html") == []
    html = (tmp_path / "report.html").read_text()
    assert "learned from 300 babbled gaits, seed 6" in html
    assert "save them as settings.toml first" in html
    assert "--babbling-seed 6" in html


def test_a_report_of_3500_hunts_stays_under_3_megabytes(results, khepera_model, tmp_path):
    many = pd.concat([results.assign(run=results["run"] + 2 * k) for k in range(42)], ignore_index=True)
    write_report(with_attrs(many, results), tmp_path / "report.html", model=khepera_model)
    assert len(many) == 3528
    assert (tmp_path / "report.html").stat().st_size < 3_000_000
    assert not re.findall(
        r"https?://", (tmp_path / "report.html").read_text().replace("http://www.w3.org/2000/svg", "")
    )


def test_results_that_say_too_little_are_refused(results, tmp_path):
    bare = results.copy()
    bare.attrs = {}
    with pytest.raises(DataError, match="do not say their settings and seed"):
        write_report(bare, tmp_path / "report.html")
    with pytest.raises(DataError, match="hold no hunt"):
        write_report(with_attrs(results.iloc[:0].copy(), results), tmp_path / "report.html")
    assert not (tmp_path / "report.html").exists()


def test_many_planners_get_a_chart_each(results):
    copies = [results.assign(planner=f"planner {k}") for k in range(5)]
    many = pd.concat(copies, ignore_index=True)
    arenas = many["arena"].nunique()
    looks = styles([f"planner {k}" for k in range(5)])
    charts = time_charts(many, SETTINGS, looks)
    assert len(charts) == 5 * arenas
    assert all(len(chart["series"]) == 1 and len(chart["ghosts"]) == 4 for chart in charts)
    assert len({chart["caption"] for chart in charts}) == len(charts)
    for chart in charts:
        (series,) = chart["series"]
        line = [tuple(map(float, point.split(","))) for point in series["line"].split()]
        band = [tuple(map(float, point.split(","))) for point in series["band"].split()]
        low, high = band[: len(band) // 2], band[len(band) // 2 :]
        assert low[-1][1] >= line[-1][1] >= high[0][1]  # pixels count downwards
