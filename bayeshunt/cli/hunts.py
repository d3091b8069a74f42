"""hunt: one episode."""

from __future__ import annotations

import json
import shlex
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any

import typer

from bayeshunt.cli.app import app
from bayeshunt.cli.options import (
    Config,
    Json,
    Model,
    Overrides,
    Preset,
    Seed,
    check_names,
    complete_arena,
    complete_planner,
    load_or_learn,
    read_experiment,
    say_chosen,
)
from bayeshunt.cli.outputs import Video, out_file, write_film

__all__ = ["hunt"]


@app.command(short_help="Run one hunt and show every decision.")
def hunt(
    planner: Annotated[
        str, typer.Option(help="Planner; bayeshunt planners lists them.", autocompletion=complete_planner)
    ] = "planning",
    arena: Annotated[
        str, typer.Option(help="Arena of the settings, e.g. walled, open.", autocompletion=complete_arena)
    ] = "open",
    theta: Annotated[float, typer.Option(help="First bearing of the prey [rad, clockwise].")] = 1.0,
    seed: Seed = 0,
    prey: Annotated[
        str | None,
        typer.Option(help="What the prey does: a behaviour, or a recorded one, recorded:tracks.parquet#ID."),
    ] = None,
    prey_model: Annotated[
        str | None,
        typer.Option(help="What the hunter learns of it: counts, constant_velocity, or a file of prey fit."),
    ] = None,
    model: Model = None,
    preset: Preset = None,
    config: Config = None,
    overrides: Overrides = None,
    babbling_seed: Annotated[int, typer.Option(help="Seed of any babbling that comes first.")] = 0,
    out: Annotated[Path | None, out_file("Write the episode as Parquet.", "episodes", ".parquet")] = None,
    replay: Annotated[Path | None, out_file("Write a page (HTML) that plays the hunt.", "pages", ".html")] = None,
    video: Video = None,
    as_json: Json = False,
) -> None:
    """Run one hunt and show every decision.

    Example:  bayeshunt hunt --planner planning --arena open --theta 1 --seed 0 --replay hunt.html;
    bayeshunt hunt --preset follow --planner prediction --prey "recorded:tracks.parquet#17" --prey-model prey.json
    """
    from bayeshunt.core.checks import check_radians
    from bayeshunt.episodes.loop import hunt as run
    from bayeshunt.experiments.preparation import learn_rooms, prepare_planner
    from bayeshunt.experiments.store.identity import model_fingerprint
    from bayeshunt.views.terminal import terminal

    check_radians(theta, "--theta")  # before anything is babbled
    overrides = [*_of_the_prey(prey, prey_model), *(overrides or ())]
    settings = read_experiment(preset, config, overrides, model)
    check_names(settings, [planner], [arena], hunting=True)
    forward = load_or_learn(model, settings, babbling_seed, quiet=as_json)
    with terminal.progress_bar("hunting", None, quiet=as_json):  # nobody knows how long it takes
        rooms = learn_rooms(settings, [planner], [arena], babbling_seed, forward)
        mind = prepare_planner(planner, forward, settings, rooms, arena)
        episode = run(settings, mind, arena=arena, theta=theta, seed=seed)
    episode = replace(episode, provenance={**episode.provenance, "model": model_fingerprint(forward)})
    if out is not None:
        episode.save(out)
    if replay is not None:
        _write_replay(episode, replay, forward, model, babbling_seed)
    filmed = None if video is None else write_film(episode, video)
    if as_json:
        files = {"out": out, "replay": replay, **({"video": video} if video else {})}
        typer.echo(json.dumps(_facts(settings, episode, files)))
        return
    if settings.scaled:
        terminal.remark(settings.scaled)
    terminal.episode_table(episode)
    say_chosen(settings, preset, config, model)
    if out is not None:
        page = shlex.quote(str(out.with_suffix(".html")))
        following = f"bayeshunt replay {shlex.quote(str(out))} --out {page}"
        terminal.say(f"{out}: {len(episode.frame)} decisions; next: {following}")
    if replay is not None:
        terminal.say(f"{replay}: open it in a browser to play the hunt")
    if filmed is not None:
        terminal.say(filmed)


def _facts(settings: Any, episode: Any, files: dict[str, Path | None]) -> dict[str, Any]:
    """How a hunt went and where it was written, as --json says it."""
    spent = {name: episode.provenance[name] for name in ("energy", "changes", "falls") if episode.spent}
    return {
        "experiment": settings.name, "caught": episode.caught, "time": episode.time, "decisions": len(episode.frame),
        "gaits": episode.frame["gait"].tolist(), **spent,
        **{name: None if path is None else str(path) for name, path in files.items()},
    }  # fmt: skip


def _of_the_prey(prey: str | None, model: str | None) -> list[str]:
    """What --prey and --prey-model set; a hunt of a recorded prey ends with its track."""
    changes = [] if model is None else [f"prey.model={model}"]
    if prey is None:
        return changes
    from bayeshunt.worlds.prey.names import is_recorded
    from bayeshunt.worlds.recorded.path import path_of

    ends = [f"protocol.time_limit={path_of(prey).duration}"] if is_recorded(prey) else []
    return [*changes, f"prey.behaviour={prey}", *ends]


def _write_replay(episode: Any, path: Path, forward: Any, model: Path | None, babbling_seed: int) -> None:
    """Write the page with the command that makes it again."""
    from bayeshunt.views.pages.commands import model_option
    from bayeshunt.views.pages.replay import write_replay

    write_replay(episode, path, model=forward, source=model_option(model, babbling_seed))
