"""The command line: thin commands over the library."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Annotated, Any

import typer

from bayeshunt.errors import BayesHuntError, InputError

app = typer.Typer(
    name="bayeshunt",
    help="""A robot babbles to learn what its body can do, learns how its prey moves, and hunts it by asking
    probability tables that anyone can open.

    The main job, the paper's experiment in one command:  bayeshunt evaluate

    Step by step:  bayeshunt babble --out b.parquet;  bayeshunt fit b.parquet --out model.json;
    bayeshunt query model.json --distance 0.1 --angle 0.5;  bayeshunt hunt --planner planning --arena open""",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
    context_settings={"help_option_names": ["-h", "--help"]},
)

Json = Annotated[bool, typer.Option("--json", help="Print JSON for machines instead of text.")]
Seed = Annotated[int, typer.Option(help="One seed, one result, bit for bit.")]
Quiet = Annotated[bool, typer.Option("--quiet", "-q", help="No progress bar.")]
Preset = Annotated[str, typer.Option(help="Experiment settings that ship, by name.")]
Config = Annotated[Path | None, typer.Option(help="Your own experiment settings: a TOML file (may start with base = \"paper\").")]
Model = Annotated[Path | None, typer.Option(help="Forward model made by fit; by default one is babbled and fitted.")]


@app.callback(invoke_without_command=True)
def root(
    version: Annotated[bool, typer.Option("--version", help="Print the version and exit.", is_eager=True)] = False,
) -> None:
    """Print the version if asked."""
    if version:
        from importlib.metadata import version as installed

        typer.echo(f"bayeshunt {installed('bayeshunt')}")
        raise typer.Exit


@app.command()
def babble(
    out: Annotated[Path, typer.Option(help="Parquet file to write.")],
    robot: Annotated[str, typer.Option(help="Robot preset (khepera, car) or the path of a TOML file.")] = "khepera",
    steps: Annotated[int, typer.Option(help="Number of gaits to execute.")] = 2000,
    seed: Seed = 0,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Let a robot execute random gaits and write down where each one took it.

    Example:  bayeshunt babble --robot khepera --steps 2000 --seed 0 --out babbling.parquet
    """
    from bayeshunt import dataset
    from bayeshunt.views import terminal
    from bayeshunt.world.babbling import babble as run

    _check_parent(out)
    with terminal.progress_bar("babbling", max(steps, 0), quiet=quiet or as_json) as advance:
        frame = run(robot, steps, seed, progress=advance)
    dataset.save(frame, out)
    facts = {"out": str(out), "rows": len(frame), "gaits": sorted(frame["gait"].unique()), "seed": seed}
    _tell(facts, as_json, f"{out}: {len(frame)} rows of {frame['gait'].nunique()} gaits; next: bayeshunt fit {out} --out model.json")


@app.command()
def fit(
    data: Annotated[Path, typer.Argument(help="Babbling table made by bayeshunt babble.", show_default=False)],
    out: Annotated[Path, typer.Option(help="Model file (JSON) to write.")],
    prior: Annotated[float, typer.Option(help="Dirichlet pseudo-count per cell; 0 is maximum likelihood.")] = 0.0,
    xmlbif: Annotated[Path | None, typer.Option(help="Also export the network as XMLBIF.")] = None,
    robot: Annotated[str | None, typer.Option(help="Robot preset or TOML, if the table does not say.")] = None,
    as_json: Json = False,
) -> None:
    """Fit the network Gait -> Distance, Angle, Heading to a babbling table.

    Example:  bayeshunt fit babbling.parquet --out model.json --xmlbif model.xmlbif
    """
    from bayeshunt import dataset
    from bayeshunt.models.forward import ForwardModel

    _check_parent(out)
    frame = dataset.load(data)
    model = ForwardModel.fit(frame, _gaits_of(frame, robot, str(data)), prior=prior)
    model.save(out)
    if xmlbif is not None:
        model.to_xmlbif(xmlbif)
    facts = {
        "out": str(out), "rows": len(frame), "prior": prior, "log_likelihood": model.log_likelihood(frame),
        "bins": {axis.name: axis.bins for axis in model.axes},
    }  # fmt: skip
    bins = ", ".join(f"{k} {v}" for k, v in facts["bins"].items())
    _tell(facts, as_json, f"{out}: {len(frame)} rows, bins {bins}, log-likelihood {facts['log_likelihood']:.1f}")


@app.command()
def query(
    model: Annotated[Path, typer.Argument(help="Model file made by bayeshunt fit.", show_default=False)],
    distance: Annotated[float, typer.Option(help="Distance of the target [m].")],
    angle: Annotated[float, typer.Option(help="Bearing of the target [rad, clockwise].")],
    heading: Annotated[float | None, typer.Option(help="Heading wanted there [rad, clockwise].")] = None,
    no_snap: Annotated[bool, typer.Option("--no-snap", help="Refuse a target that was never babbled.")] = False,
    as_json: Json = False,
) -> None:
    """Ask the inverse model which gait reaches a target: P(Gait | Distance, Angle [, Heading]).

    Example:  bayeshunt query model.json --distance 0.10 --angle 0.5
    """
    from bayeshunt.models.forward import ForwardModel
    from bayeshunt.models.inverse import InverseModel

    answer = InverseModel(ForwardModel.load(model)).posterior(distance, angle, heading, snap=not no_snap)
    if as_json:
        facts = {
            "probabilities": {str(k): float(v) for k, v in answer.probabilities.items()}, "best": answer.best,
            "evidence": answer.evidence, "evidence_probability": float(answer.evidence_probability),
            "support": int(answer.support), "snapped": bool(answer.snapped),
            "cell": {k: v for k, v in answer.cell._asdict().items()},
        }  # fmt: skip
        typer.echo(json.dumps(facts))
        return
    from bayeshunt.views import terminal

    terminal.posterior_bars(answer)


@app.command()
def hunt(
    planner: Annotated[str, typer.Option(help="Planner, e.g. reactive, prediction, planning.")] = "planning",
    arena: Annotated[str, typer.Option(help="Arena of the settings, e.g. walled, open.")] = "open",
    theta: Annotated[float, typer.Option(help="First bearing of the prey [rad, clockwise].")] = 1.0,
    seed: Seed = 0,
    model: Model = None,
    preset: Preset = "paper",
    config: Config = None,
    out: Annotated[Path | None, typer.Option(help="Write the episode as Parquet.")] = None,
    as_json: Json = False,
) -> None:
    """Run one hunt and show every decision.

    Example:  bayeshunt hunt --planner planning --arena open --theta 1 --seed 0 --out hunt.parquet
    """
    from bayeshunt.hunting import hunt as run
    from bayeshunt.planners.registry import make_planner
    from bayeshunt.settings import load_experiment

    if out is not None:
        _check_parent(out)
    settings = load_experiment(config or preset)
    _check_names(settings, [planner], [arena])
    forward = _model(model, settings, 0)
    mind = make_planner(planner, forward, **settings.planner.get(planner, {}))
    episode = run(settings, mind, arena=arena, theta=theta, seed=seed)
    if out is not None:
        episode.save(out)
    if as_json:
        facts = {"caught": episode.caught, "time": episode.time, "decisions": len(episode.frame), "gaits": episode.frame["gait"].tolist()}
        typer.echo(json.dumps({**facts, "out": None if out is None else str(out)}))
        return
    from bayeshunt.views import terminal

    terminal.episode_table(episode)


@app.command()
def evaluate(
    model: Model = None,
    preset: Preset = "paper",
    config: Config = None,
    planner: Annotated[list[str] | None, typer.Option(help="Planner; may be given several times.")] = None,
    arena: Annotated[list[str] | None, typer.Option(help="Arena; may be given several times.")] = None,
    runs: Annotated[int | None, typer.Option(help="Runs per bearing; the settings' by default.")] = None,
    seed: Seed = 0,
    jobs: Annotated[int, typer.Option(help="Worker processes; -1 for one per core.")] = -1,
    out: Annotated[Path | None, typer.Option(help="Folder for every hunt and the summary.")] = None,
    per_theta: Annotated[bool, typer.Option("--per-theta", help="Show every bearing, not just the totals.")] = False,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Run the paper's experiment and print its table beside ours.

    Without --model the robot babbles and the model is fitted first.

    Example:  bayeshunt evaluate --runs 100 --seed 0 --out results
    """
    from bayeshunt.experiments import runner, store
    from bayeshunt.views import terminal

    settings = runner.experiment_settings(config or preset, runs)
    planners = _check_names(settings, planner, arena)
    runner.check_jobs(jobs)
    if out is not None:
        store.check_output_folder(out)
    forward = _model(model, settings, seed)
    total = len(settings.protocol.thetas) * settings.protocol.runs * len(planners) * len(arena or settings.arenas)
    with terminal.progress_bar("hunting", total, quiet=quiet or as_json) as advance:
        results = runner.evaluate(
            settings, seed=seed, jobs=jobs, planners=planners, arenas=arena, model=forward, progress=advance
        )
    if out is not None:
        store.save_results(results, settings, seed, out)
    facts = store.summary(results, settings, seed)
    if as_json:
        typer.echo(json.dumps(facts))
        return
    terminal.success_table(facts, per_theta=per_theta)
    if out is not None:
        terminal.say(f"every hunt and the summary are in {out}")


@app.command()
def settings(
    name: Annotated[str, typer.Argument(help="experiment or robot")] = "experiment",
    as_json: Json = False,
) -> None:
    """List every key of a settings file with its unit, range and default."""
    from bayeshunt.settings import describe

    rows = describe(name)
    if as_json:
        typer.echo(json.dumps(rows))
        return
    from bayeshunt.views import terminal

    terminal.settings_table(rows)


def main() -> None:
    """Run the command line; exit 2 for wrong input, 1 for failed work, each with one line on stderr."""
    command = typer.main.get_command(app)
    try:
        status = command.main(prog_name="bayeshunt", standalone_mode=False)
    except InputError as error:
        _fail(error, 2)
    except BayesHuntError as error:
        _fail(error, 1)
    except (KeyboardInterrupt, typer.Abort):
        _fail("stopped", 130)
    except BrokenPipeError:
        sys.stderr.close()
        sys.exit(0)
    except Exception as error:
        if not hasattr(error, "format_message"):  # not a usage error: a defect, which deserves its traceback
            raise
        _fail(error.format_message().splitlines()[0] + " (see --help)", 2)
    sys.exit(status if isinstance(status, int) else 0)


def _fail(message: Any, status: int) -> None:
    line = " ".join(str(message).split())
    print(f"bayeshunt: {line}", file=sys.stderr)
    sys.exit(status)


def _tell(facts: dict[str, Any], as_json: bool, text: str) -> None:
    typer.echo(json.dumps(facts) if as_json else text)


def _check_parent(path: Path) -> None:
    """Fail before the work rather than after it."""
    if path.is_dir():
        raise InputError(f"{path}: is a folder; expected a file name")
    if not path.parent.is_dir():
        raise InputError(f"{path}: the folder {path.parent} does not exist; make it first")


def _check_names(settings: Any, planners: list[str] | None, arenas: list[str] | None) -> list[str]:
    """Return the planners to run; InputError for an unknown planner or arena, before any work."""
    from bayeshunt.planners.registry import planner_names

    chosen = list(planners or settings.planners)
    for name in chosen:
        if name not in planner_names():
            raise InputError(f"unknown planner {name!r}; expected one of {', '.join(planner_names())}")
    for name in arenas or ():
        if name not in settings.arenas:
            raise InputError(f"unknown arena {name!r}; expected one of {', '.join(settings.arenas)}")
    return chosen


def _model(path: Path | None, settings: Any, seed: int) -> Any:
    """Load the model, or babble and fit one."""
    from bayeshunt.experiments.protocol import learn_model
    from bayeshunt.experiments.runner import check_model
    from bayeshunt.models.forward import ForwardModel

    if path is None:
        return learn_model(settings, seed)
    model = ForwardModel.load(path)
    check_model(model, settings)
    return model


def _gaits_of(frame: Any, robot: str | None, source: str) -> Any:
    """The repertoire of a babbling table: the robot given, or the one in its provenance."""
    from bayeshunt.config import RobotSettings
    from bayeshunt.dataset import PROVENANCE_KEY
    from bayeshunt.settings import load_robot, parse

    if robot is not None:
        return load_robot(robot).gaits
    recorded = frame.attrs.get(PROVENANCE_KEY, {}).get("robot")
    if recorded is None:
        raise InputError(f"{source}: the table does not say which robot made it; add --robot")
    return parse(RobotSettings, recorded, f"{source}: provenance: robot").gaits
