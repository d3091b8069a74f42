"""Every example of every --help runs, in the order of the command reference, in one folder."""

import sys
from collections import Counter

import pytest
from blocks import ROOT, Block, lines
from brought import bring, bring_more
from reader import Reader

sys.path.insert(0, str(ROOT / "docs" / "building"))
made = pytest.importorskip("made", reason="needs nbformat")


def examples() -> list[tuple[str, Block]]:
    """Each command with the block that the reference shows of its example."""
    sections = ((name, made.command_section(name, command)) for name, command in made.commands())
    return [(name, Block("sh", text.split("```sh\n")[1].split("```")[0])) for name, text in sections]


def test_an_example_is_of_its_own_command():
    for name, block in examples():
        calls = [" ".join(line.words) for line in lines(block)]
        assert calls, name
        if name not in ("bayeshunt", "bayeshunt prey"):
            assert any(call.startswith(name) for call in calls), (name, calls)


@pytest.mark.slow
def test_every_example_runs(tmp_path, bayeshunt, monkeypatch):
    bring(tmp_path)
    monkeypatch.setenv("MPLBACKEND", "Agg")
    bring_more(tmp_path, bayeshunt)
    reader = Reader(tmp_path, bayeshunt)
    ran = Counter({name: reader.read(block) for name, block in examples()})
    assert all(ran.values())
