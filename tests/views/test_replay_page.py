"""The replay page without a browser: what it holds, how big it is, what it refuses to carry."""

from __future__ import annotations

import base64
import hashlib
import json
import math
import re
from dataclasses import replace
from html.parser import HTMLParser

import numpy as np
import pytest

import bayeshunt as bh
from bayeshunt.core.errors import InputError
from bayeshunt.core.geometry import Polar, Pose
from bayeshunt.views.pages.page import embed
from bayeshunt.views.pages.replay import replay_data, replay_html, write_replay

PAPER = bh.load_experiment("paper")
NASTY = '</script><img src=x onerror="alert(1)">&amp;<!--'


@pytest.fixture(scope="module")
def episodes(khepera_model):
    return {
        name: bh.hunt(PAPER, bh.make_planner(name, khepera_model), arena="open", theta=4.0, seed=1)
        for name in ("reactive", "prediction", "planning", "omniscient", "pure_pursuit")
    }


class Page(HTMLParser):
    """Balance of tags, scripts and addresses of a page."""

    def __init__(self, text):
        super().__init__(convert_charrefs=True)
        self.open, self.scripts, self.addresses, self.text = [], [], [], []
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.addresses += [value for name, value in attrs if name in ("src", "href")]
        assert not [name for name, _ in attrs if name.startswith("on") or name == "style"]
        if tag not in ("meta", "link", "input", "br", "img"):
            self.open.append(tag)
        if tag == "script":
            self.scripts.append("")

    def handle_startendtag(self, tag, attrs):
        pass

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        (self.text if not self.open or self.open[-1] != "script" else []).append(data)
        if self.open and self.open[-1] == "script":
            self.scripts[-1] += data


def world(row, path):
    hunter = Pose(*(row[f"hunter_{k}"] for k in Pose._fields))
    return np.stack(hunter.compose(path), axis=1)


def test_the_table_keeps_what_the_plans_said(episodes, tmp_path):
    for name, episode in episodes.items():
        episode.save(tmp_path / "hunt.parquet")
        loaded = bh.Episode.load(tmp_path / "hunt.parquet").frame.to_dict("records")
        for row, again, plan in zip(episode.frame.to_dict("records"), loaded, episode.plans, strict=True):
            if plan.predicted_prey is not None:
                for part in Polar._fields:
                    np.testing.assert_array_equal(row[f"predicted_{part}"], getattr(plan.predicted_prey, part))
                    np.testing.assert_array_equal(again[f"predicted_{part}"], row[f"predicted_{part}"])
            if plan.posterior is None:
                values = dict(zip(again["alternative_gaits"], again["alternative_values"], strict=True))
                assert values[plan.gait] == pytest.approx(plan.value, abs=1e-12)
                assert min(values.values()) == values[plan.gait], name
            else:
                assert row["alternative_gaits"] is None
                np.testing.assert_array_equal(again["posterior"], plan.posterior)


def test_alternatives_are_the_least_values_of_the_subtrees(episodes):
    for row, plan in zip(episodes["planning"].frame.to_dict("records"), episodes["planning"].plans, strict=True):
        nodes = plan.trace[plan.trace["T"] > 0]
        first = nodes["gaits"].str.replace(r" x\d+.*", "", regex=True)
        expected = nodes.groupby(first)["value_m"].min().to_dict()
        assert dict(zip(row["alternative_gaits"], row["alternative_values"], strict=True)) == expected


def test_the_prey_table_grows_by_one_transition_a_step(episodes):
    for episode in episodes.values():
        final = episode.situations[-1].prey_model
        last = list(episode.frame["prey_table"])[-1]
        assert [cell[3] for cell in last] == final.cpt()["count"].tolist()
        for k, table in enumerate(episode.frame["prey_table"]):
            assert sum(cell[3] for cell in table) == k


@pytest.mark.parametrize("name", ["reactive", "prediction"])
def test_a_file_alone_says_how_sure_every_posterior_is(episodes, khepera_model, tmp_path, name):
    """And opens it down to the counts of its cells; the rows themselves are the model's."""
    episode = episodes[name]
    episode.save(tmp_path / "hunt.parquet")
    loaded = bh.Episode.load(tmp_path / "hunt.parquet")
    alone, fresh = replay_data(loaded)["steps"], replay_data(episode)["steps"]
    asked = replay_data(loaded, model=khepera_model)["steps"]
    for step, own, again, plan in zip(alone, fresh, asked, episode.plans, strict=True):
        found = plan.answer.interval()
        np.testing.assert_allclose([ends[:2] for ends in step["bars"]["within"]], found[["low", "high"]], rtol=1e-3)
        assert step["bars"] == own["bars"] == again["bars"]
        kept, whole = step["opened"], own["opened"]
        assert {**kept, "best": "", "rows": None} == {**whole, "best": "", "rows": None}
        assert whole == again["opened"]
        assert np.prod(kept["factors"], axis=0).sum() == pytest.approx(plan.evidence_probability, rel=1e-4)
        assert [rows["count"] for rows in whole["rows"]] == [counts[plan.answer.model.gaits.index(plan.gait)]
                                                             for counts in kept["counts"]]  # fmt: skip
    loaded.save(tmp_path / "again.parquet")
    assert (tmp_path / "again.parquet").read_bytes() == (tmp_path / "hunt.parquet").read_bytes()


def test_a_heading_that_is_not_known_is_none(episodes):
    """A page must not hold NaN, which is no JSON, and no heading that nobody predicted."""
    episode = episodes["omniscient"]
    data = replay_data(episode)
    json.dumps(data, allow_nan=False)
    for row, step, plan in zip(episode.frame.to_dict("records"), data["steps"], episode.plans, strict=True):
        assert [theta for _, _, theta in step["predicted"][1:]] == [None] * len(plan.gaits)
        places = [[x, y] for x, y, _ in step["predicted"]]
        np.testing.assert_allclose(places, world(row, plan.predicted_prey)[:, :2], atol=6e-5)
        assert step["target"][2] is None
        assert math.isnan(row["target_heading"])


def test_world_paths_come_from_what_the_hunter_sees(episodes, khepera_model):
    episode = episodes["planning"]
    data = replay_data(episode)
    for row, step, plan in zip(episode.frame.to_dict("records"), data["steps"], episode.plans, strict=True):
        if plan.prey_known:
            np.testing.assert_allclose(step["predicted"], world(row, plan.predicted_prey), atol=6e-5)
            assert all(math.isfinite(theta) for _, _, theta in step["predicted"])
        else:  # the prey is taken to stand still
            assert step["predicted"] == []
        branch = plan.trace[plan.trace["chosen"]]
        path = Polar.from_cartesian(branch["hunter_forward"], branch["hunter_right"], branch["hunter_heading"])
        np.testing.assert_allclose(step["planned"], world(row, path), atol=6e-5)
        assert step["aimed"] == (len(plan.gaits) if plan.prey_known else -1)
    reactive = episodes["reactive"]
    assert all(step["planned"] == [] for step in replay_data(reactive)["steps"])
    row, step = reactive.frame.iloc[2], replay_data(reactive, model=khepera_model)["steps"][2]
    end = world(row, Polar(*(np.array([v]) for v in khepera_model.predict(row["gait"]))))
    np.testing.assert_allclose(step["planned"][-1], end[0], atol=6e-5)


def test_the_trail_starts_at_the_start_and_ends_at_the_end(episodes):
    episode = episodes["prediction"]
    for every in (1, 2, 7):
        trail = replay_data(episode, every=every)["trail"]
        assert trail["time"][0] == 0.0
        assert trail["time"][-1] == pytest.approx(episode.trail["time"].iloc[-1], abs=5e-5)
        np.testing.assert_allclose(trail["hunter"][0][:2], [0, 0], atol=1e-9)
        last = episode.trail[["prey_x", "prey_y", "prey_theta"]].iloc[-1]
        np.testing.assert_allclose(trail["prey"][-1], last, atol=6e-5)


def test_fresh_marks_the_cell_of_the_last_transition(episodes):
    """The marked row is the one whose count has just grown."""
    tables = [{tuple(cell[:3]): cell[3] for cell in table} for table in episodes["prediction"].frame["prey_table"]]
    steps = replay_data(episodes["prediction"])["steps"]
    for before, after, step in zip(tables, tables[1:], steps[1:], strict=False):
        (grown,) = [cell for cell, count in after.items() if count != before.get(cell, 0)]
        assert step["prey"][step["fresh"]][:3] == pytest.approx(grown, rel=1e-5)


def test_a_minute_of_hunting_stays_small_and_asks_for_nothing(episodes, khepera_model):
    missed = next(e for e in episodes.values() if not e.caught)
    html = replay_html(missed, model=khepera_model)
    assert len(html.encode()) < 300_000
    page = Page(html)
    assert page.open == []
    assert all(address.startswith("data:") for address in page.addresses)
    assert not re.findall(r"https?://(?!www\.w3\.org/)", html)


def test_only_the_page_s_own_script_may_run(episodes):
    html = replay_html(episodes["planning"])
    policy = re.search(r'Content-Security-Policy" content="([^"]+)"', html).group(1).replace("&#39;", "'")
    allowed = re.findall(r"script-src '(sha256-[^']+)'", policy)
    scripts = [s for s in Page(html).scripts if not s.startswith("{")]
    digests = [f"sha256-{base64.b64encode(hashlib.sha256(s.encode()).digest()).decode()}" for s in scripts]
    assert digests == allowed
    assert "default-src 'none'" in policy
    assert "unsafe" not in policy


def test_nasty_names_stay_text(episodes):
    episode = episodes["planning"]
    frame = episode.frame.assign(
        gait=NASTY, planned_gaits=[[NASTY]] * len(episode.frame), objective=NASTY, alternative_gaits=None
    )
    provenance = {**episode.provenance, "planner": NASTY, "settings": {**episode.provenance["settings"], "note": NASTY}}
    html = replay_html(replace(episode, frame=frame, provenance=provenance, plans=(), situations=()))
    page = Page(html)
    assert page.open == []
    assert len(page.scripts) == 2
    hunt = json.loads(page.scripts[0])
    assert hunt["planner"] == hunt["note"] == hunt["steps"][0]["gait"] == NASTY
    assert "onerror" not in re.sub(r'\\u003c|"[^"]*"', "", html.split("<script")[0]).replace("onerror=&#34;", "")


def test_embedded_json_reads_back_and_never_holds_markup():
    data = {"text": NASTY + "\u2028", "number": 0.1, "none": None}
    text = str(embed(data))
    assert json.loads(text) == data
    assert not set("<>&\u2028") & set(text)
    with pytest.raises(ValueError, match="JSON"):
        embed({"number": float("nan")})


def test_a_hunt_without_a_decision_is_refused_in_one_line(episodes, tmp_path):
    empty = replace(episodes["planning"], frame=episodes["planning"].frame.iloc[:0])
    with pytest.raises(InputError, match="ended before its first decision"):
        write_replay(empty, tmp_path / "hunt.html")
    assert not (tmp_path / "hunt.html").exists()


@pytest.mark.parametrize("given", [1, None, "hunt.parquet"])
def test_what_is_no_episode_is_refused(tmp_path, given):
    with pytest.raises(InputError, match=r"episode: expected an Episode, as hunt\(\) returns it, got"):
        write_replay(given, tmp_path / "hunt.html")
    assert not list(tmp_path.iterdir())
