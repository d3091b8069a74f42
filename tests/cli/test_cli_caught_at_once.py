"""A hunt whose prey starts within reach: one clear line in the place of an empty table's legend."""

import sys

import pytest

from bayeshunt import cli


def test_a_catch_before_the_first_decision_is_said(monkeypatch, capsys):
    command = ["hunt", "--arena", "open", "--planner", "reactive", "--set", "protocol.catch_distance=100"]
    monkeypatch.setattr(sys, "argv", ["bayeshunt", *command])
    with pytest.raises(SystemExit) as left:
        cli.main()
    assert not left.value.code
    shown = capsys.readouterr().out
    assert "no decision was made: the prey starts within the catch distance." in shown
    assert "value:" not in shown
