"""reference, remember, explore: tables that planners need and that are made beforehand; routes: what a map is worth."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import Annotated, Any

import typer

from bayeshunt.cli.app import app
from bayeshunt.cli.options import (
    Arenas,
    Config,
    Json,
    Overrides,
    Preset,
    Quiet,
    Seed,
    check_names,
    complete_planner,
    evaluate_words,
    read_experiment,
    tell,
)
from bayeshunt.cli.outputs import out_file, out_folder, out_map

__all__ = ["explore", "reference", "remember", "routes"]


@app.command(short_help="Compute the best the gaits allow, for planner reference.")
def reference(
    out: Annotated[Path, out_file("Table (.npz) to write.", "such tables", ".npz")],
    preset: Preset = None,
    config: Config = None,
    overrides: Overrides = None,
    seed: Seed = 0,
    samples: Annotated[int, typer.Option(help="Sampled paths per gait.")] = 16,
    angles: Annotated[int, typer.Option(help="Grid lines per full turn.")] = 72,
    cache: Annotated[Path | None, out_folder("Folder where tables are kept and found again.")] = None,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Compute the best that the gaits allow against a straight prey (value iteration), for planner reference.

    Example:  bayeshunt reference --out reference.npz;
    bayeshunt evaluate --planner reference --set planner.reference.table=reference.npz
    """
    from bayeshunt.experiments.studies import references
    from bayeshunt.views.terminal import terminal

    settings = read_experiment(preset, config, overrides)
    expected = len(settings.robot.gait) + references.EXPECTED_SWEEPS
    with terminal.progress_bar("solving", expected, quiet=quiet or as_json) as advance:
        table = references.reference(
            settings, seed=seed, samples=samples, angles=angles, headings=angles, cache=cache, progress=advance
        )
    table.save(out)
    facts = {"out": str(out), "states": int(table.values.size), "digest": table.facts["digest"]}
    following = evaluate_words(preset, config, overrides)
    tell(facts, as_json, f"{out}: {facts['states']} relative poses; next: {following} --planner reference "
         f"--set {shlex.quote(f'planner.reference.table={out}')}")  # fmt: skip


@app.command(short_help="Watch prey beforehand, for planners that remember.")
def remember(
    out: Annotated[Path, out_file("Memory (JSON) to write.", "memories", ".json")],
    preset: Preset = None,
    config: Config = None,
    overrides: Overrides = None,
    arena: Arenas = None,
    planner: Annotated[
        str, typer.Option(help="Who hunts while the prey is watched.", autocompletion=complete_planner)
    ] = "reactive",
    runs: Annotated[int, typer.Option(help="Training hunts per bearing and arena.")] = 30,
    seed: Seed = 0,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Watch prey in training hunts and keep their transitions, for the planners that remember.

    No evaluation uses the seeds of training hunts, whatever --seed is.

    Example:  bayeshunt remember --out memory.json;
    bayeshunt evaluate --planner memory_place --set planner.memory_place.tables=memory.json
    """
    from bayeshunt.experiments.studies import memories
    from bayeshunt.views.terminal import terminal

    settings = read_experiment(preset, config, overrides)
    check_names(settings, [planner], arena, hunting=True)
    total = len(settings.protocol.thetas) * max(runs, 0) * len(arena or settings.arenas)
    with terminal.progress_bar("watching", total, quiet=quiet or as_json) as advance:
        memory = memories.remember(settings, arenas=arena, planner=planner, runs=runs, seed=seed, progress=advance)
    memory.save(out)
    facts = {"out": str(out), "transitions": memory.observations, **memory.provenance}
    following = evaluate_words(preset, config, overrides)
    tell(facts, as_json, f"{out}: {memory.observations} transitions; next: {following} --planner memory_place "
         f"--set {shlex.quote(f'planner.memory_place.tables={out}')}")  # fmt: skip


@app.command(short_help="Learn an arena's walls and free space, for planners intercept_walls and detour.")
def explore(
    out: Annotated[Path, out_file("Room (JSON) to write.", "rooms", ".json")],
    arena: Annotated[str, typer.Option(help="Arena to babble in.")] = "walled",
    steps: Annotated[int, typer.Option(help="Gaits babbled there.")] = 1000,
    drawn: Annotated[Path | None, out_map("Map to write too: a page (.html) or a figure (.png, .svg).")] = None,
    preset: Preset = None,
    config: Config = None,
    overrides: Overrides = None,
    seed: Seed = 0,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Babble alone in an arena and keep its walls and where the robot can be, for planners intercept_walls and detour.

    The table of free space counts, cell by cell, how often the robot was there and how often it was stopped.

    Example:  bayeshunt explore --arena walled --out room.json --map room.html;
    bayeshunt evaluate --planner intercept_walls --arena walled --set planner.intercept_walls.room=room.json
    """
    from bayeshunt.experiments import preparation
    from bayeshunt.views.terminal import terminal

    settings = read_experiment(preset, config, overrides)
    total = max(steps, 0) + settings.model.babbling_steps
    with terminal.progress_bar("exploring", total, quiet=quiet or as_json) as advance:
        room = preparation.learn_room(settings, arena=arena, steps=steps, seed=seed, progress=advance)
    room.save(out)
    walls, space = room.walls(), room.space
    if drawn is not None:
        from bayeshunt.views.pages.maps import write_map

        write_map(room, drawn)
    facts: dict[str, Any] = {"out": str(out), "arena": arena, "walls": walls.round(4).to_dict("records")}
    if space is not None:
        visited, hit = (int((table > 0).sum()) for table in (space.visits, space.hits))
        facts |= {"cell_m": space.cell, "cells_visited": visited, "cells_hit": hit}
    following = evaluate_words(preset, config, overrides)
    tell(facts, as_json, f"{out}: {_shown(walls, steps)}\n"
         f"next: {following} --planner intercept_walls --arena {shlex.quote(arena)} "
         f"--set {shlex.quote(f'planner.intercept_walls.room={out}')}")  # fmt: skip


@app.command(short_help="Which way round is chosen, against how well the arena is known.")
def routes(
    preset: Preset = "portia",
    config: Config = None,
    overrides: Overrides = None,
    explored: Annotated[
        list[int] | None, typer.Option(help="Gaits babbled in the arena beforehand; may be given several times.")
    ] = None,
    looks: Annotated[
        list[int] | None, typer.Option(help="Looks around from the start instead; may be given several times.")
    ] = None,
    maps: Annotated[int, typer.Option(help="Maps of each kind, per arena.")] = 4,
    runs: Annotated[int, typer.Option(help="Hunts with each map, per bearing.")] = 3,
    seed: Seed = 0,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Hunt a lure behind a barrier with planner detour: which side is chosen first, is it right, does it arrive?

    A row per number of gaits babbled in the arena beforehand, and per number of looks around from the start: from the
    ground, where obstacles hide what is behind them, and raised above them. A side chosen by chance is right in 50 %.

    Example:  bayeshunt routes --preset portia --explored 250 --explored 2000 --looks 5
    """
    from bayeshunt.experiments.studies import routes as studies
    from bayeshunt.views.terminal import terminal

    settings = read_experiment(None if config else preset, config, overrides)
    chosen = list(studies.EXPLORED) if explored is None and looks is None else explored or []
    around = list(studies.LOOKS) if explored is None and looks is None else looks or []
    kinds = len(chosen) + 2 * len(around)
    total = kinds * len(settings.arenas) * max(maps, 0) * max(runs, 0) * len(settings.protocol.thetas)
    with terminal.progress_bar("hunting", total, quiet=quiet or as_json) as advance:
        frame = studies.routes(
            settings, explored=chosen, looks=around, maps=maps, runs=runs, seed=seed, progress=advance
        )
    if as_json:
        typer.echo(frame.to_json(orient="records"))
        return
    terminal.routes_table(frame)


def _shown(walls: Any, steps: int) -> str:
    """A room in words: how many walls, and each of them in a row."""
    from bayeshunt.views.terminal.text_tables import align

    if not len(walls):
        return f"no walls found; {steps} gaits met none"
    rows = [
        [f"{value:.3f}" if isinstance(value, float) else str(value) for value in row]
        for row in walls.itertuples(index=False)
    ]
    counted = "1 wall" if len(walls) == 1 else f"{len(walls)} walls"
    return "\n".join([counted, *align(list(walls.columns), rows, left=set())])
