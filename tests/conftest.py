"""What many tests share: one small babbling table, the model fitted to it, and the command line as typed."""

import os
from operator import itemgetter

import hypothesis
import pytest
from joblib.externals.loky import ProcessPoolExecutor

from bayeshunt.cli import main
from bayeshunt.config.loading import load_robot
from bayeshunt.config.schema import drives
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.models.target import registry as prey_models
from bayeshunt.perception import registry as perception
from bayeshunt.planners import registry
from bayeshunt.worlds import bodies
from bayeshunt.worlds import registry as worlds
from bayeshunt.worlds.babbling import babble
from bayeshunt.worlds.prey import behaviours

# Output as in a pipe of 80 columns, whatever terminal or service runs the tests; child processes too.
os.environ["COLUMNS"] = "80"
for name in ("FORCE_COLOR", "TTY_COMPATIBLE", "TTY_INTERACTIVE"):
    os.environ.pop(name, None)

# A busy machine is no fault of the code: no example is timed.
hypothesis.settings.register_profile("untimed", deadline=None)
hypothesis.settings.load_profile("untimed")


@pytest.fixture(scope="session")
def khepera_frame():
    """400 babbled gaits of the Khepera."""
    return babble("khepera", 400, 0)


@pytest.fixture(scope="session")
def khepera_model(khepera_frame):
    """The forward model of those."""
    return ForwardModel.fit(khepera_frame, load_robot("khepera").gaits)


@pytest.fixture(scope="session")
def worker():
    """Send a thing to a worker process and back, as an evaluation sends its model: a function."""
    # A pool of its own: joblib goes on with loky's shared one and expects to have made it.
    with ProcessPoolExecutor(max_workers=1) as pool:
        yield lambda thing: pool.submit(itemgetter(0), (thing,)).result(timeout=60)


#: Everything by name that a test may add to.
REGISTRIES = (
    behaviours._BEHAVIOURS, registry._REGISTRY, bodies._BODIES, drives._DRIVES, worlds._WORLDS, perception._SENSORS,
    perception._TRACKERS, prey_models._MODELS,
)  # fmt: skip


@pytest.fixture(autouse=True)
def registered_again():
    """Forget, after every test, what it has registered."""
    kept = [(known, dict(known)) for known in REGISTRIES]
    yield
    for known, before in kept:
        known.clear()
        known.update(before)


@pytest.fixture
def folder(tmp_path):
    """The working folder of the commands; a module may override it."""
    return tmp_path


@pytest.fixture
def bayeshunt(folder, monkeypatch, capfd):
    """Run a command in ``folder`` as a user types it: returns its output and its messages."""
    monkeypatch.chdir(folder)

    def run(*arguments, status=0):
        monkeypatch.setattr("sys.argv", ["bayeshunt", *arguments])
        with pytest.raises(SystemExit) as stopped:
            main()
        out, err = capfd.readouterr()
        assert stopped.value.code == status, err
        return out, err

    return run
