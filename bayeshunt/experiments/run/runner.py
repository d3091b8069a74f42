"""Running the protocol: every hunt once, on as many workers as asked, with one result for one seed."""

from __future__ import annotations

import contextlib
import inspect
import os
import shlex
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any, Never

import pandas as pd

from bayeshunt.config.loading import DEFAULT_PRESET, load_experiment
from bayeshunt.config.schema import ExperimentSettings
from bayeshunt.core.arguments import checked_but
from bayeshunt.core.checks import check_whole
from bayeshunt.core.errors import InputError, ResultsError, did_you_mean
from bayeshunt.episodes.loop import Result
from bayeshunt.experiments.preparation import check_model, check_planners, learn_rooms, prepare_planner
from bayeshunt.experiments.protocol import HuntTask, learn_model, names_of, plan_hunts
from bayeshunt.experiments.run import workers
from bayeshunt.experiments.run.batches import Ticket, batches, run_batch
from bayeshunt.experiments.run.plugins import check_names
from bayeshunt.experiments.store.database import HuntDatabase, Numbered
from bayeshunt.experiments.store.export import check_output_folder, check_same_export, save_results
from bayeshunt.experiments.store.identity import Identity, fingerprint, model_fingerprint, versions
from bayeshunt.files.locks import FolderLock
from bayeshunt.models.arena.rooms import RoomModel
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.models.formats import model_file as model_files
from bayeshunt.models.tables.structures import NAIVE

__all__ = ["Progress", "Say", "check_jobs", "check_minds", "evaluate", "experiment_settings", "results_frame"]

#: Called with the number of hunts that have just ended (or had ended before).
Progress = Callable[[int], None]
#: Called with one line that the user should see.
Say = Callable[[str], None]


@checked_but("planners", "arenas", "model")
def evaluate(
    experiment: str | os.PathLike[str] | ExperimentSettings = DEFAULT_PRESET,
    *,
    runs: int | None = None,
    seed: int = 0,
    jobs: int = 1,
    planners: str | Sequence[str] | None = None,
    arenas: str | Sequence[str] | None = None,
    model: ForwardModel | None = None,
    out: str | os.PathLike[str] | None = None,
    scheduler: str | None = None,
    progress: Progress | None = None,
    say: Say | None = None,
    **mistaken: Never,
) -> pd.DataFrame:
    """Run the experiment and return one row per hunt.

    experiment: preset name, TOML path or settings. runs: per bearing, the settings' by default.
    seed: of every hunt and, if no model is given, of the babbling it is learned from.
    jobs: worker processes; -1 for one per core. planners, arenas: names, the settings' by default.
    out: folder of the results. Every hunt is committed there as it ends; the same call on the same
        folder goes on where the last one stopped, whatever stopped it.
    scheduler: None, "local" or the address of a dask scheduler ("tcp://host:port").
    say: called with a line of news, for example that damaged rows are run again.

    Columns: planner, arena, theta [rad], run, seed (of that hunt), caught, time [s, the limit if
    missed], decisions, transitions (changes of gait), distance [m]; energy [J] and falls of a body that measures
    what it spends. The same seed gives the same table at any ``jobs``, with any ``scheduler``, and after any
    number of interruptions.
    ``frame.attrs`` holds the ``settings`` used, the ``seed``, the fingerprint of the ``model`` (None: imported)
    and its ``structure``.

    Raises InputError for a wrong argument, name or number, ResultsError if ``out`` holds another experiment or
    is damaged, FolderInUseError if another process is working there.
    """
    for name in mistaken:
        raise InputError(f"evaluate: unknown argument {name}{_near(name)}")
    settings = experiment_settings(experiment, runs)
    check_names(settings)
    check_jobs(jobs)
    workers.check_scheduler(scheduler)
    check_whole(seed, "seed", 0)
    planners = names_of(planners, settings.planners, "planners")
    arenas = names_of(arenas, tuple(settings.arenas), "arenas")
    check_planners(settings, planners)
    tasks = plan_hunts(settings, planners, arenas, seed)
    if model is not None:
        check_minds(planners, model, settings)
        if out is not None and not model.has_counts:
            raise InputError(
                "an imported network has no counts, which a folder of results needs; evaluate without out (--out)"
            )
    with contextlib.ExitStack() as stack:
        database = None
        if out is not None:
            folder = check_output_folder(out)
            stack.enter_context(FolderLock(folder, f"watch it with: bayeshunt status {shlex.quote(str(folder))}"))
            given = None if model is None else model_fingerprint(model)
            asked = Identity.of(settings, planners, arenas, seed, given)
            database = stack.enter_context(_open_or_create(folder, asked, model, settings))
            model = ForwardModel.loads(database.model, f"{database.path}: the model in it")
        elif model is None:
            model = learn_model(settings, seed)
            check_minds(planners, model, settings)
        rooms = learn_rooms(settings, planners, arenas, seed, model)
        evaluation = _Evaluation(settings, model, rooms, tasks, database, progress or _ignore, say or _ignore)
        ended = evaluation.run(jobs, scheduler)
        frame = results_frame(tasks, ended, settings, seed)
        frame.attrs["model"] = model_fingerprint(model)
        frame.attrs["structure"] = NAIVE.name if model.structure.edges == NAIVE.edges else model.structure.name
        if database is not None:
            database.fold()
            save_results(frame, settings, seed, database.path.parent)
    return frame


def _open_or_create(
    folder: Path, asked: Identity, model: ForwardModel | None, settings: ExperimentSettings
) -> HuntDatabase:
    """Open the folder's database if it is of the same experiment; make it if there is none."""
    database = HuntDatabase.open(folder)
    if database is not None:
        difference = database.identity.difference(asked)
        if difference is None:
            return database
        database.__exit__()
        raise ResultsError(f"{folder} holds another experiment: {difference}; choose another --out")
    check_same_export(folder, settings, asked)
    if model is None:
        model = learn_model(settings, asked.seed)
        check_minds(asked.planners, model, settings)
    text = model_files.dumps(model)
    return HuntDatabase.create(folder, replace(asked, model=fingerprint(text)), text)


class _Evaluation:
    """Hunts to run, hunts that have ended."""

    def __init__(
        self, settings: ExperimentSettings, model: ForwardModel, rooms: dict[str, RoomModel],
        tasks: Sequence[HuntTask], database: HuntDatabase | None, progress: Progress, say: Say,
    ) -> None:  # fmt: skip
        self.settings, self.model, self.rooms = settings, model, rooms
        self.hunts = [Numbered(number, task) for number, task in enumerate(tasks)]
        self.database, self.progress, self.say = database, progress, say
        self.ended: dict[int, Result] = {}

    def run(self, jobs: int, scheduler: str | None) -> dict[int, Result]:
        """Run what is missing; return every hunt's result by its number."""
        if self.database is not None:
            self.database.begin_session()
        # A worker on this machine commits each hunt itself; one elsewhere sends it back.
        sink = self.database.sink if self.database is not None and scheduler is None else None
        call = partial(run_batch, self.settings, self.model, self.rooms, sink, versions(), Ticket.new())

        def run(hunts: Sequence[Numbered]) -> Iterator[list[tuple[Numbered, Result]]]:
            yield from workers.parallel(call, batches(hunts), jobs=jobs, scheduler=scheduler)

        for pairs in workers.work_off(self._missing, run):
            if self.database is not None:
                self.database.check_in_place()
                if sink is None:
                    self.database.add_all(pairs)
            self._note({hunt.number: result for hunt, result in pairs})
        return self.ended

    def _missing(self) -> list[Numbered]:
        if self.database is not None:
            self._collect()
        return [hunt for hunt in self.hunts if hunt.number not in self.ended]

    def _collect(self) -> None:
        """Take over what is in the database; rows that are damaged are dropped, to be run again."""
        assert self.database is not None
        done, damaged = self.database.results()
        if damaged:
            self.say(f"{self.database.path}: {len(damaged)} damaged rows dropped; their hunts are run again")
            self.database.drop(damaged)
        self._note(done)

    def _note(self, results: dict[int, Result]) -> None:
        new = {number: result for number, result in results.items() if number not in self.ended}
        self.ended.update(new)
        if new:
            self.progress(len(new))


def experiment_settings(
    experiment: str | os.PathLike[str] | ExperimentSettings, runs: int | None = None
) -> ExperimentSettings:
    """Return the experiment's settings, with ``runs`` per bearing if given."""
    return load_experiment(experiment, None if runs is None else {"protocol.runs": runs})


def check_minds(planners: str | Sequence[str], model: ForwardModel, settings: ExperimentSettings) -> None:
    """Raise InputError for a wrong model, planner or setting of one: before any work, and not in a worker."""
    check_model(model, settings)
    stand_in = {"": RoomModel.empty()}  # the rooms themselves are learned when all else is known to be right
    for name in names_of(planners, (), "planners"):
        prepare_planner(name, model, settings, stand_in, "")


def results_frame(
    tasks: Sequence[HuntTask], ended: dict[int, Result], settings: ExperimentSettings, seed: int
) -> pd.DataFrame:
    """Return one row per hunt, in the order of the protocol, whatever the order they ended in."""
    frame = pd.DataFrame(
        [(*task, *ended[number]) for number, task in enumerate(tasks)], columns=[*HuntTask._fields, *Result._fields]
    )
    frame["caught"] = frame["caught"].astype(bool)
    if not frame["energy"].any():  # a body that does not measure what it spends does not know when it falls either
        frame = frame.drop(columns=["energy", "falls"])
    frame.attrs = {"settings": settings.model_dump(mode="json"), "seed": int(seed)}
    return frame


check_jobs = workers.check_jobs


def _near(name: str) -> str:
    """What an unknown argument may have meant: "; did you mean planners?", or nothing."""
    return did_you_mean(name, inspect.signature(evaluate).parameters, listed=False).replace("'", "")


def _ignore(_: Any) -> None:
    return None
