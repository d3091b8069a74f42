"""What the promises share: a printed figure each, and a fitted model on disk."""

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent.parent / "models"))  # model_cases: random networks, babbling tables


@pytest.fixture
def figure(capsys):
    """A function that prints one line although pytest captures the rest."""

    def say(text):
        with capsys.disabled():
            print(f"\n  {text}", flush=True)

    return say


@pytest.fixture(scope="session")
def model_file(khepera_model, tmp_path_factory):
    """A fitted model on disk."""
    path = tmp_path_factory.mktemp("model") / "model.json"
    khepera_model.save(path)
    return path
