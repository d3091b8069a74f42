"""The planner that CONTRIBUTING.md shows is a planner."""

import re
from pathlib import Path

import pytest

import bayeshunt as bh
from bayeshunt.experiments.run.plugins import load_plugin
from bayeshunt.planners import registry

TEXT = (Path(__file__).parent.parent / "CONTRIBUTING.md").read_text(encoding="utf-8")
SECTION = TEXT.split("## Add a planner")[1].split("\n## ")[0]
PLUGIN, CHECK = re.findall(r"```python\n(.*?)```", SECTION, re.DOTALL)


@pytest.fixture
def clean_registry(monkeypatch):
    monkeypatch.setattr(registry, "_REGISTRY", dict(registry._REGISTRY))


def test_the_planner_shown_runs_and_conforms(clean_registry, tmp_path):
    (tmp_path / "nearest.py").write_text(PLUGIN)
    names = vars(load_plugin(tmp_path / "nearest.py"))
    exec(CHECK, names)  # it is what a reader would type
    episode, model = names["episode"], names["model"]
    assert episode.caught
    plan = bh.make_planner("nearest", model).plan(episode.situations[0], rng=None)
    assert len(plan.trace) == len(model.gaits)
    assert plan.trace.loc[plan.trace["value_m"].idxmin(), "gait"] == plan.gait
    for told in (str(plan), str(episode), plan._repr_html_(), episode._repr_html_()):
        assert plan.gait in told
    assert "distance left at the end of the step [mm]" in str(plan)


def test_it_is_found_by_the_line_shown(clean_registry, bayeshunt, tmp_path, monkeypatch):
    line = re.search(r"`bayeshunt (--plugin nearest.py evaluate [^`]*)`", SECTION)[1]
    (tmp_path / "nearest.py").write_text(PLUGIN)
    monkeypatch.chdir(tmp_path)
    out, _ = bayeshunt(*line.split(), "--runs", "1", "--jobs", "1", "--quiet")
    assert "nearest" in out
