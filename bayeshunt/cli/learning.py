"""babble, fit, query: from a robot to a model that answers."""

from __future__ import annotations

import json
import math
import shlex
from pathlib import Path
from typing import Annotated, Any

import typer

from bayeshunt.cli import ingest
from bayeshunt.cli.app import app
from bayeshunt.cli.options import Json, Quiet, Seed, asked_backoff, complete_robot, complete_structure, gaits_of, tell
from bayeshunt.cli.outputs import out_file
from bayeshunt.cli.stopping import stoppable
from bayeshunt.core.errors import InputError

__all__ = ["babble", "fit", "opened", "query"]


@app.command(short_help="Let a robot try random gaits; write where each took it.")
def babble(
    out: Annotated[Path, out_file("Parquet file to write.", "tables", ".parquet")],
    robot: Annotated[
        str,
        typer.Option(help="Robot preset (khepera, car) or the path of a TOML file.", autocompletion=complete_robot),
    ] = "khepera",
    steps: Annotated[int, typer.Option(help="Number of gaits to execute.")] = 2000,
    seed: Seed = 0,
    active: Annotated[
        bool,
        typer.Option("--active", help="Execute the gait whose next row is expected to tell most, not a random one."),
    ] = False,
    jobs: Annotated[int, typer.Option(help="Worker processes for more than 100,000 steps; -1: one per core.")] = -1,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Let a robot execute random gaits and write down where each one took it.

    More than 100,000 steps are babbled in shards by all workers, in bounded memory; the same line after
    an interruption goes on with the shards that are missing.

    Example:  bayeshunt babble --robot khepera --steps 2000 --seed 0 --out babbling.parquet
    """
    from bayeshunt.config.loading import load_robot
    from bayeshunt.experiments.studies.active import babble_actively_to_file
    from bayeshunt.experiments.studies.babbling import babble_to_file, kept_rows
    from bayeshunt.views.terminal import terminal

    def kept() -> str:
        rows = kept_rows(out)
        if not rows:
            return "nothing is kept yet (large tables are kept in shards of 100,000 rows)"
        return f"{rows:,} of {steps:,} rows are kept in {out}.shards; give the same line again to go on"

    with stoppable(kept), terminal.progress_bar("babbling", max(steps, 0), quiet=quiet or as_json) as advance:
        if active:
            gaits = babble_actively_to_file(robot, steps, seed, out, progress=advance)
        else:
            gaits = babble_to_file(robot, steps, seed, out, jobs=jobs, progress=advance)
    facts = {"out": str(out), "rows": steps, "gaits": gaits, "seed": seed}
    following, all_gaits = f"bayeshunt fit {shlex.quote(str(out))} --out model.json", len(load_robot(robot).gait)
    if len(gaits) < all_gaits:
        following += f" --prior 0.03   ({len(gaits)} of {all_gaits} gaits; babble more, or fit with a prior)"
    tell(facts, as_json, f"{out}: {steps} rows of {len(gaits)} gaits; next: {following}")


@app.command(short_help="Fit the network Gait -> Distance, Angle, Heading.")
@ingest.reads_logs
def fit(
    data: Annotated[
        list[Path], typer.Argument(help="Babbling tables made by bayeshunt babble, of one robot.", show_default=False)
    ],
    out: Annotated[Path, out_file("Model file (JSON) to write.", "models", ".json")],
    prior: Annotated[
        float | None,
        typer.Option(
            help="Dirichlet pseudo-count per cell; 0 is maximum likelihood.", show_default="0; with back-off 0.03"
        ),
    ] = None,
    xmlbif: Annotated[
        Path | None, out_file("Also export the network as XMLBIF, with its labels.", "networks", ".xmlbif")
    ] = None,
    robot: Annotated[str | None, typer.Option(help="Robot preset or TOML, if the table does not say.")] = None,
    structure: Annotated[
        str,
        typer.Option(
            help="naive (the paper), tan, joint, previous_gait or learned: what depends on what; see assess. Or one of "
            "your own, 'NAME: Gait->Distance, Gait->Angle, Gait->Heading, Angle->Heading'.",
            autocompletion=complete_structure,
        ),
    ] = "naive",
    backoff: Annotated[
        float | None,
        typer.Option(
            help="Of previous_gait: rows that a gait's own table is worth after each gait; 0: the prior alone.",
            show_default="5 for previous_gait",
        ),
    ] = None,
    residual_of: Annotated[
        str | None,
        typer.Option(help="unicycle: fit the commands' own motion, and tables of what it misses; rows in memory."),
    ] = None,
    effects: Annotated[
        str,
        typer.Option(help="Nodes beside the gait: Distance,Angle,Heading and, as a fourth, Energy; rows in memory."),
    ] = "Distance,Angle,Heading",
    auto_bins: Annotated[
        bool, typer.Option("--auto-bins", help="Bins of the highest held-out density, instead of these three.")
    ] = False,
    distance_bin: Annotated[float, typer.Option(help="Width of a distance bin [body lengths].")] = 0.1,
    angle_bins: Annotated[int, typer.Option(min=1, max=3600, help="Bins of the full turn for Angle.")] = 36,
    heading_bins: Annotated[int, typer.Option(min=1, max=3600, help="Bins of the full turn for Heading.")] = 36,
    gait_prior: Annotated[str, typer.Option(help="P(Gait): uniform, or empirical (as often as babbled).")] = "uniform",
    asked: Any = None,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Fit the network Gait -> Distance, Angle, Heading to one or more babbling tables of any size, or to logs.

    Example:  bayeshunt fit babbling.parquet --out model.json --xmlbif model.xmlbif;
    bayeshunt fit log.csv --time-step 1 --gaits 25 --out model.json
    """
    from bayeshunt.config.loading import recorded_gaits
    from bayeshunt.core.bins import EffectAxes
    from bayeshunt.models.tables.structures import Structure
    from bayeshunt.views.terminal import terminal

    tables, notes = opened(data, asked, robot)
    for note in () if as_json else notes:
        terminal.say(note)
    if robot is None:
        repertoire = recorded_gaits(tables[0].provenance, f"{data[0]}: ")
    else:
        repertoire = gaits_of(robot, [table.provenance for table in tables])
    axes = EffectAxes.standard(
        repertoire.body_length, distance_bin=distance_bin, angle_bins=angle_bins, heading_bins=heading_bins
    )
    rows = sum(table.rows for table in tables)
    edges = Structure.read(structure) if "->" in structure else structure
    how = {"prior": prior, "gait_prior": gait_prior, "structure": edges, "backoff": asked_backoff(backoff)}
    nodes = [name.strip() for name in effects.split(",") if name.strip()]
    with terminal.progress_bar("counting", rows, quiet=quiet or as_json) as advance:
        model = _fitted(tables, repertoire, axes, how, residual_of, nodes, auto_bins, advance)
    counts = model.source.counted
    model.save(out)
    if xmlbif is not None:
        model.to_xmlbif(xmlbif)
    facts = {
        "out": str(out), "rows": counts.total, "prior": model.prior, "log_likelihood": model.log_likelihood(counts),
        "bins": {axis.name: axis.bins for axis in model.axes.all},
        "structure": model.structure.name, "edges": [list(edge) for edge in model.structure.edges],
        "backoff": model.backoff, "residual_of": residual_of,
    }  # fmt: skip
    bins = ", ".join(f"{axis.name} {axis.bins}" for axis in model.axes.all)
    counted = f"{counts.total} rows" + ("" if counts.total == rows else f" of {rows} (the others had no gait before)")
    following = f"\nnext: bayeshunt query {shlex.quote(str(out))} {_some_target(model)}" if counts.total else ""
    beside = "" if residual_of is None else f"residuals of the {residual_of}, "
    tell(
        facts,
        as_json,
        f"{out}: {counted}, {beside}bins {bins}, log-likelihood {facts['log_likelihood']:.1f}{following}",
    )


def _fitted(
    tables: list[Any], gaits: Any, axes: Any, how: dict[str, Any], residual_of: str | None, nodes: list[str],
    auto_bins: bool, progress: Any,
) -> Any:  # fmt: skip
    """Return the model of tables: counted batch by batch, or in memory where the rows choose motion or bins first."""
    from bayeshunt.core.bins import EFFECTS
    from bayeshunt.models.body.forward import ForwardModel
    from bayeshunt.models.counting.streaming import count_tables, rows_of

    if residual_of is None and not auto_bins and nodes == [*EFFECTS]:
        seen, provenance = count_tables(tables, gaits, axes=axes, structure=how["structure"], progress=progress)
        return ForwardModel.from_counts(seen, **how, provenance=provenance)
    frame, provenance = rows_of(tables, gaits, progress)
    fitted = ForwardModel.fit(
        frame, gaits, **how, axes="auto" if auto_bins else axes, residual_of=residual_of, effects=nodes
    )
    return ForwardModel.over(fitted.source, provenance)


def opened(data: list[Path], asked: Any, robot: str | None) -> tuple[list[Any], list[str]]:
    """Return the babbling tables of files, logs made into one table, and what there is to say of that."""
    from bayeshunt.data.ingesting import Held, babbling_from, needs_ingesting
    from bayeshunt.models.counting.streaming import open_tables

    if robot is not None or not all(path.exists() and needs_ingesting(path) for path in data):
        return open_tables(data), []
    frame = babbling_from(data, asked)
    return [Held(frame, str(data[0]))], ingest.recorded_notes(frame.attrs["bayeshunt"], data[0])


def _some_target(model: Any) -> str:
    """Options of query that ask for a place where babbling led often, well away from where the robot began."""
    cells, rows, axes = model.binned.learned_cells, model.binned.joint.support, model.binned.axes
    far = cells[cells[:, 0] >= sorted(cells[:, 0])[len(cells) // 2]]
    near, turned = max(far.tolist(), key=lambda cell: rows[*cell])
    return f"--distance {axes.distance.centres[near]:.3g} --angle {axes.angle.centres[turned]:.2g}"


@app.command(short_help="Ask which gait reaches a target, and on what grounds.")
def query(
    model: Annotated[
        Path, typer.Argument(help="Model file made by bayeshunt fit, or a network (.xmlbif, .bif).", show_default=False)
    ],
    distance: Annotated[float, typer.Option(help="Distance of the target [m].")],
    angle: Annotated[float, typer.Option(help="Bearing of the target [rad, clockwise].")],
    heading: Annotated[float | None, typer.Option(help="Heading wanted there [rad, clockwise].")] = None,
    energy: Annotated[
        float | None, typer.Option(help="Energy that the step is to cost [J], for a model with the node Energy.")
    ] = None,
    previous_gait: Annotated[
        str | None, typer.Option(help="Gait executed just before, for a model of structure previous_gait.")
    ] = None,
    no_snap: Annotated[bool, typer.Option("--no-snap", help="Refuse a target of probability 0.")] = False,
    explain: Annotated[bool, typer.Option("--explain", help="Say what each variable speaks for or against.")] = False,
    as_json: Json = False,
) -> None:
    """Ask the inverse model which gait reaches a target: P(Gait | Distance, Angle [, Heading] [, Energy]).

    Example:  bayeshunt query model.json --distance 0.10 --angle 0.5
    """
    from bayeshunt.core.checks import check_radians
    from bayeshunt.models.body.inverse import InverseModel
    from bayeshunt.models.formats.interchange import open_model
    from bayeshunt.models.tables.structures import depends_on_previous

    check_radians(angle, "--angle")
    if heading is not None:
        check_radians(heading, "--heading")
    forward = open_model(model)
    if previous_gait is not None and not depends_on_previous(forward.structure):
        raise InputError(f"{model}: what a gait does depends on no gait before; fit with --structure previous_gait")
    answer = (
        InverseModel(forward).after(previous_gait).posterior(distance, angle, heading, energy=energy, snap=not no_snap)
    )
    if as_json:
        facts = {
            "probabilities": {str(k): float(v) for k, v in answer.probabilities.items()}, "best": answer.best,
            "evidence": answer.evidence, "evidence_probability": float(answer.evidence_probability),
            "support": answer.support, "snapped": bool(answer.snapped),
            "cell": answer.cell._asdict(), "asked": answer.target._asdict(), "farthest": answer.farthest,
            "beyond": answer.beyond, "gap": answer.gap, "heading_gap": answer.heading_gap,
            "interval": _interval(answer),
            **({"energy": _energy(answer)} if answer.model.knows_energy else {}),
        }  # fmt: skip
        if explain:
            facts["explanation"] = _plain(answer.explain())
        typer.echo(json.dumps(facts))
        return
    from bayeshunt.views.terminal import terminal

    terminal.posterior_bars(answer)
    if explain:
        terminal.explanation_table(answer)


def _interval(answer: Any) -> dict[str, Any] | None:
    """Low, median and high by gait at the level said; None where nobody knows the counts."""
    if not answer.model.has_counts:
        return None
    found = answer.interval()
    return {**found.attrs, **{end: {str(k): float(v) for k, v in found[end].items()} for end in found}}


def _energy(answer: Any) -> dict[str, Any]:
    """What each gait costs here: rows, mean, interval and spread [J]."""
    frame = answer.model.energy()
    frame = frame[frame["previous_gait"].isna()] if frame["previous_gait"].isna().any() else frame
    names = ["rows", "mean_j", "low_j", "high_j", "sd_j"]
    found = frame.set_index("gait")[names].astype(object).where(frame.set_index("gait")[names].notna(), None)
    return {str(gait): dict(row) for gait, row in found.to_dict("index").items()}


def _plain(frame: Any) -> dict[str, dict[str, Any]]:
    """A table as JSON by row; infinities, which JSON lacks, as "inf" and "-inf"."""
    rows = {str(name): dict(row) for name, row in frame.to_dict("index").items()}
    return {
        name: {key: str(v) if v in (math.inf, -math.inf) else v for key, v in row.items()} for name, row in rows.items()
    }
