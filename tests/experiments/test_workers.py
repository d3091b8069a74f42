"""Workers that die, and what is said about the ones that cannot be had."""

import os
import signal
import time

import pytest

from bayeshunt.config.loading import load_experiment
from bayeshunt.core.errors import BayesHuntError, InputError, WorkerError
from bayeshunt.experiments.run import workers
from bayeshunt.experiments.run.runner import evaluate
from bayeshunt.experiments.studies.memories import remember


def die_once(folder, item):
    """Kill the worker the first time that item 3 comes."""
    flag = folder / "died"
    if item == 3 and not flag.exists():
        flag.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return item


def die(item):
    os.kill(os.getpid(), signal.SIGKILL)


def fail(item):
    raise InputError("item 1 is wrong")


def work(call, items):
    done = []

    def missing():
        return [item for item in items if item not in done]

    for output in workers.work_off(missing, lambda todo: workers.parallel(call, todo, jobs=2)):
        done.append(output)
    return done


def test_a_killed_worker_costs_only_time(tmp_path):
    from functools import partial

    assert sorted(work(partial(die_once, tmp_path), range(8))) == list(range(8))
    assert (tmp_path / "died").exists()


@pytest.mark.slow
def test_workers_that_always_die_are_given_up():
    with pytest.raises(WorkerError, match="killed 3 times in a row"):
        work(die, range(2))


def test_an_error_in_a_worker_arrives_as_it_is():
    with pytest.raises(InputError, match=r"^item 1 is wrong$"):
        work(fail, range(2))


def test_a_worker_ends_when_its_parent_has():
    reading, writing = os.pipe()
    parent = os.fork()
    if not parent:
        parent = os.getpid()
        if not os.fork():  # the worker, which is guarded before its parent is killed
            workers.guard_worker(parent)
            os.write(writing, str(os.getpid()).encode())
        time.sleep(120)
        os._exit(0)
    worker = int(os.read(reading, 20))
    assert alive(worker)
    os.kill(parent, signal.SIGKILL)
    os.waitpid(parent, 0)
    for _ in range(300):
        if not alive(worker):
            return
        time.sleep(0.1)
    os.kill(worker, signal.SIGKILL)
    pytest.fail("the worker outlived its parent")


def alive(pid):
    try:
        with open(f"/proc/{pid}/stat") as stat:  # noqa: PTH123
            return stat.read().rsplit(")", 1)[1].split()[0] != "Z"
    except OSError:
        return False


def test_a_worker_with_other_versions_is_refused():
    with pytest.raises(BayesHuntError, match=r"a worker has numpy 1\.0, this process 2\.0"):
        workers.check_worker_versions({"numpy": "2.0"}, {"numpy": "1.0"})


@pytest.mark.parametrize(
    ("scheduler", "message"),
    [("everywhere", "expected local or an address"), ("tcp://127.0.0.1:1", "no dask scheduler answers there")],
)
def test_a_scheduler_that_is_not_there_is_one_line(khepera_model, monkeypatch, scheduler, message):
    monkeypatch.setattr(workers, "_PATIENCE", 1)
    with pytest.raises(InputError, match=message) as error:
        evaluate("paper", runs=1, planners=["reactive"], model=khepera_model, scheduler=scheduler)
    assert "\n" not in str(error.value)


def test_a_pool_that_is_used_again_works_where_the_caller_now_stands(tmp_path, monkeypatch, khepera_model):
    for name in ("one", "two"):  # the second finds the workers of the first
        (tmp_path / name).mkdir()
        monkeypatch.chdir(tmp_path / name)
        remember("paper", arenas=["open"], planner="reactive", runs=1, model=khepera_model).save(f"{name}.json")
        found = evaluate(
            load_experiment("paper", {"planner.memory_place.tables": f"{name}.json"}),
            runs=1, jobs=2, planners=["memory_place"], arenas=["open"], model=khepera_model, out="results",
        )  # fmt: skip
        assert len(found) == 7
