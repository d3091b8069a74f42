"""The doctor: what is there, whether it works, and a status that scripts can use."""

import importlib.metadata
import json

from bayeshunt.cli import doctor


def test_a_sound_installation(bayeshunt):
    out, err = bayeshunt("doctor", "--json")
    facts = json.loads(out)
    assert [step["error"] for step in facts["self_test"]] == [None] * 4
    assert facts["packages"]["numpy"] == importlib.metadata.version("numpy")
    assert {"notebook"} <= facts["extras"].keys()
    assert not {"test", "docs"} & facts["extras"].keys()
    assert err == ""


def test_the_page_says_what_to_send(bayeshunt, monkeypatch):
    monkeypatch.setattr(doctor, "_STEPS", (("babble", lambda made: None),))
    out, _ = bayeshunt("doctor")
    assert "A bug report: this page, the line that you typed" in out
    assert "babble" in out
    assert "ok" in out


def test_a_step_that_fails_is_named(bayeshunt, monkeypatch):
    def broken(made):
        raise OSError("no such engine")

    steps = (("babble", broken), ("fit", lambda made: made["frame"]))
    monkeypatch.setattr(doctor, "_STEPS", steps)
    out, err = bayeshunt("doctor", status=1)
    assert "OSError: no such engine" in out
    assert "fit" not in out.split("Self-test")[1]
    assert err == "bayeshunt: babble: OSError: no such engine\n"


def test_what_is_missing_is_named(bayeshunt, monkeypatch):
    lines = ["numpy>=1.26", "nowhere>=3", 'gone[all]>=1 ; extra == "gym"', 'pytest>=8 ; extra == "test"']
    monkeypatch.setattr(importlib.metadata, "requires", lambda name: lines)
    monkeypatch.setattr(doctor, "_STEPS", ())
    out, err = bayeshunt("doctor", status=1)
    assert "MISSING      >=3\n" in out
    assert "lacks gone" in out
    assert err == "bayeshunt: nowhere is not installed\n"
    assert [need.range for need in doctor.needs()] == [">=1.26", ">=3", ">=1"]
