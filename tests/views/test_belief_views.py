"""What a belief looks like: its sheet, an episode's columns, the replay."""

import json
import re

import numpy as np
import pytest

import bayeshunt as bh
from bayeshunt.views.pages.replay import replay_data, replay_html


@pytest.fixture(scope="module")
def episode(khepera_model):
    settings = bh.load_experiment(
        "paper", {"sensing.preset": "camera_narrow", "sensing.tracker_settings": {"particles": 400}}
    )
    return bh.hunt(settings, bh.make_planner("search", khepera_model), arena="open", theta=2.0, seed=1)


def test_a_belief_shows_itself_as_text_and_as_a_drawing(episode):
    belief = episode.situations[1].belief
    text, html = str(belief), belief._repr_html_()
    for word in ("P(prey in cell)", "Sightings", "resultant", "particles"):
        assert word in text
        assert word in html
    assert html.count("<circle") >= 400
    likeliest = belief.table()["probability"].max()
    assert f"{likeliest:.3f}" in text
    assert repr(belief).startswith("<ParticleBelief: ")


def test_a_row_of_the_episode_says_what_the_table_says(episode, tmp_path):
    episode.save(tmp_path / "hunt.parquet")
    stored = bh.Episode.load(tmp_path / "hunt.parquet").frame
    for number, situation in enumerate(episode.situations):
        row = stored.iloc[number]
        table = situation.belief.table()
        shown = table.loc[table["probability"] >= 0.005, "probability"].sort_values(ascending=False)
        assert [cell[4] for cell in row["belief_table"]] == pytest.approx(shown.tolist())
        assert row["belief_in_view"] == pytest.approx(situation.belief.in_view())
        assert len(row["cloud_distance"]) == 120
        assert np.isfinite(np.array(row["cloud_angle"])).all()


def test_the_replay_has_the_belief_in_step(episode):
    data = replay_data(episode)
    assert data["fov"][0] == pytest.approx(np.pi / 6, abs=1e-3)
    for step, (_, row) in zip(data["steps"], episode.frame.iterrows(), strict=True):
        assert len(step["belief"]["cloud"]) == 120
        assert len(step["belief"]["sighted"]) == len(row["sighted_distance"])
        assert step["belief"]["table"][0][2] == pytest.approx(row["belief_table"][0][4], abs=1e-4)
    first = np.hypot(*(np.array(data["steps"][0]["belief"]["sighted"][0]) - data["trail"]["prey"][0][:2]))
    assert first < 0.05  # shown where it was
    page = replay_html(episode)
    kept = json.loads(re.search(r'type="application/json"[^>]*>(.*?)</script>', page, re.DOTALL)[1])
    assert kept["steps"][0]["belief"] == data["steps"][0]["belief"]


def test_a_hunt_without_a_camera_has_none_of_it(khepera_model):
    plain = bh.hunt("paper", bh.make_planner("intercept", khepera_model), arena="open", theta=0.0, seed=1)
    assert not [name for name in plain.frame if name.startswith(("belief", "cloud", "sighted"))]
    data = replay_data(plain)
    assert data["fov"] is None
    assert data["steps"][0]["belief"] is None


def test_expected_counts_are_shown_as_they_are(episode):
    learned = episode.situations[-1].prey_model
    assert any(count % 1 for count in learned.counts["count"])
    assert "P(Distance, Angle, Heading)" in str(learned)
    assert "<svg" in learned._repr_html_()
