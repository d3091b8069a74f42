"""Completion as bash asks for it, and words that are nearly right."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

#: What was typed, and a word that it may become.
TYPED = {
    "bayeshunt ev": "evaluate",
    "bayeshunt hunt --planner inter": "intercept_walls",
    "bayeshunt evaluate --preset pa": "paper",
    "bayeshunt evaluate --arena wal": "walled",
    "bayeshunt hunt --arena wal": "walled",
    "bayeshunt fit --structure ta": "tan",
    "bayeshunt babble --robot khep": "khepera",
    "bayeshunt prey s": "score",
    "bayeshunt fit --gait-": "--gait-prior",
}
#: A word misspelt, and what was meant.
MISSPELT = {
    ("evalute",): "evaluate", ("hunt", "--planer", "x"): "--planner", ("hunt", "--planner", "planing"): "planning",
    ("settings", "robt"): "robot", ("presets", "papr"): "paper", ("robots", "kepera"): "khepera",
    ("prey", "scor"): "score", ("hunt", "--arena", "wallled"): "walled", ("hunt", "--set", "prey.sped=2"): "speed",
    ("planners", "interecpt"): "intercept", ("evaluate", "--set", "tsk.time_limit=3"): "'protocol.time_limit'",
    ("ingest", "log", "a.csv", "--timestep", "1"): "'--time-step'",
}  # fmt: skip


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("bash") is None, reason="needs bash")
def test_bash_completes(tmp_path):
    """The script that --show-completion prints, sourced in a bash that then asks for words."""
    program = tmp_path / "bin" / "bayeshunt"
    program.parent.mkdir()
    program.write_text(f"#!{sys.executable}\nfrom bayeshunt.cli import main\nmain()\n")
    program.chmod(0o755)
    root = str(Path(__file__).parents[2])
    paths = {"PATH": f"{program.parent}{os.pathsep}{os.environ['PATH']}", "PYTHONPATH": root}
    environment = {**os.environ, **paths, "_TYPER_COMPLETE_TEST_DISABLE_SHELL_DETECTION": "1"}
    command = [str(program), "--show-completion", "bash"]
    shown = subprocess.run(command, env=environment, capture_output=True, text=True, check=True).stdout
    asked = "\n".join(
        f"COMP_WORDS=({line}); COMP_CWORD={len(line.split()) - 1}; COMPREPLY=(); _bayeshunt_completion bayeshunt; "
        'echo "${COMPREPLY[*]}"'
        for line in TYPED
    )
    ran = subprocess.run(
        ["bash", "-c", f"{shown}\n{asked}"], env=environment, capture_output=True, text=True, check=True
    )
    answers = ran.stdout.splitlines()
    assert len(answers) == len(TYPED), ran.stderr
    for (line, word), answer in zip(TYPED.items(), answers, strict=True):
        assert word in answer.split(), line


@pytest.mark.parametrize("words", MISSPELT, ids=" ".join)
def test_did_you_mean(words, bayeshunt):
    _, err = bayeshunt(*words, status=2)
    assert len(err.splitlines()) == 1
    suggestion = max(err.find("id you mean"), err.find("Possible options"))
    assert suggestion > 0
    assert MISSPELT[words] in err[suggestion:]
