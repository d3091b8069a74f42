"""Warnings made errors: nothing that ships may warn on the way to a first table."""

import subprocess
import sys


def test_babbling_survives_warnings_as_errors():
    # in a process of its own: Box2D is imported once, and an error inside its import crashes the interpreter
    code = "import bayeshunt; print(len(bayeshunt.babble('khepera', 2, 0)))"
    done = subprocess.run([sys.executable, "-W", "error", "-c", code], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr[-400:]
    assert done.stdout.strip() == "2"
