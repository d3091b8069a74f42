"""Pages made from the program itself: its public names, its commands, its settings, what there is to choose from."""

from __future__ import annotations

import inspect
import io
import os
import textwrap
from collections.abc import Iterator
from typing import Any

import gallery

import bayeshunt as bh

STAR = ("", " \\*")
#: Layers of the package in the order of the road, and what a reader finds in each.
LAYERS = {
    "core": "poses, bins, gaits, errors",
    "data": "recordings and babbling tables",
    "models": "forward, inverse and prey models; their scores",
    "worlds": "bodies, worlds, prey, babbling",
    "perception": "sensors and trackers",
    "planners": "from a situation to a plan",
    "episodes": "hunts and loops of one's own",
    "experiments": "evaluations and studies",
    "config": "settings",
    "views": "pages and widgets",
    "envs": "Gymnasium and PettingZoo",
}


def pages() -> dict[str, Any]:
    """Every page by its place."""
    return {**api_pages(), "reference/commands.md": commands_page(), **settings_pages(), **catalogue_pages()}


def api_names() -> dict[str, list[str]]:
    """Public names by the layer that they live in."""
    names: dict[str, list[str]] = {layer: [] for layer in LAYERS}
    for name in bh.__all__:
        if name not in ("__version__", "protocols"):
            names.setdefault(bh._HOMES[name][0].split(".")[1], []).append(name)
    return {layer: found for layer, found in names.items() if found}


def api_pages() -> dict[str, str]:
    """The reference of ``bayeshunt.__all__``: an index, a page for each layer, the protocols."""
    lines = [
        "# Python reference", "",
        "`import bayeshunt as bh`; these are its public names. SI units: metres, seconds, radians; angles as a robot",
        "sees them are clockwise, poses in the world counter-clockwise. `bh.__version__` is the version.", "",
        "| name | what it is |", "| --- | --- |", f"| [`bh.protocols`](protocols.md) | {first_line(bh.protocols)} |",
    ]  # fmt: skip
    made = {"reference/protocols.md": "# bh.protocols\n\n::: bayeshunt.protocols\n    options: {show_root_heading: false}\n"}
    for layer, names in api_names().items():
        parts = [f"# {layer}: {LAYERS.get(layer, '')}".rstrip(": ")]
        for name in names:
            home, attribute = bh._HOMES[name]
            thing = getattr(bh, name)
            target = f"{thing.__module__}.{thing.__qualname__}" if hasattr(thing, "__qualname__") else f"{home}.{attribute}"
            parts.append(f'<a id="bh.{name}"></a>\n\n::: {target}\n    options: {{heading: "bh.{name}", toc_label: "{name}"}}')
            lines.append(f"| [`bh.{name}`]({layer}.md#bh.{name}) | {first_line(thing)} |")
        made[f"reference/{layer}.md"] = "\n\n".join(parts) + "\n"
    return {**made, "reference/index.md": "\n".join(lines) + "\n"}


def first_line(thing: Any) -> str:
    """The first line of its docstring, fit for a cell of a table."""
    import re

    line = (inspect.getdoc(thing) or "").splitlines()[:1]
    return re.sub(r":[a-z]+:`~?\.?([^`]+)`", r"`\1`", line[0] if line else "").replace("|", "\\|")


def commands() -> Iterator[tuple[str, Any]]:
    """Every command of the command line with its name as typed."""
    import typer

    from bayeshunt.cli.app import app

    def walk(name: str, command: Any) -> Iterator[tuple[str, Any]]:
        yield name, command
        for child in getattr(command, "commands", {}).values():
            yield from walk(f"{name} {child.name}", child)

    __import__("bayeshunt.cli")
    yield from walk("bayeshunt", typer.main.get_command(app))


def commands_page() -> str:
    """All commands on one page."""
    found = list(commands())
    parts = [
        "# Commands",
        "Each explains itself with `--help`, prints JSON with `--json` where it has something to say, and exits with 0, 1"
        " (the work failed) or 2 (the input is wrong: one line with the place and the fix)."
        " `bayeshunt --install-completion` adds completion to your shell.",
        "| command | what it does |\n| --- | --- |\n"
        + "\n".join(f"| [`{name}`](#{anchor(name)}) | {command.get_short_help_str(90)} |" for name, command in found[1:]),
    ]  # fmt: skip
    parts += [command_section(name, command) for name, command in found]
    return "\n\n".join(parts) + "\n"


def anchor(name: str) -> str:
    """The anchor of a command's section."""
    return name.replace(" ", "-")


def command_section(name: str, command: Any) -> str:
    """What ``--help`` says of a command."""
    text = inspect.cleandoc(command.help or "")
    parts = [f"## {name} {{ #{anchor(name)} }}"]
    for paragraph in text.split("\n\n"):
        if paragraph.startswith("Example"):
            lines = " ".join(paragraph.partition(":")[2].split()).split("; ")
            parts.append("```sh\n" + "\n".join(lines) + "\n```")
        else:
            parts.append(" ".join(paragraph.split()).replace("|", "\\|"))
    rows = [row for row in map(option_row, command.params) if row]
    return "\n\n".join([*parts, "\n".join(["| option | meaning |", "| --- | --- |", *rows])])


def option_row(parameter: Any) -> str:
    """A row for an option or an argument."""
    names = [*parameter.opts, *parameter.secondary_opts]
    said = getattr(parameter, "help", None) or ""
    if "--help" in names or getattr(parameter, "hidden", False):
        return ""
    default = parameter.default
    shown = getattr(parameter, "show_default", False)
    if isinstance(shown, str):
        said += f" Default: {shown}."
    elif shown and default is not None and not callable(default) and default not in (False, [], ()):
        said += f" Default: {default}."
    if parameter.required:
        said += " Required."
    name = ", ".join(f"`{n}`" for n in names) if names[0].startswith("-") else f"`{parameter.name}`"
    return f"| {name} | {escaped(said)} |"


def escaped(text: str) -> str:
    """Text for a cell of a table."""
    return " ".join(str(text).split()).replace("|", "\\|").replace("<", "&lt;").replace("*", "\\*")


def settings_pages() -> dict[str, str]:
    """Every key of a settings file."""
    from bayeshunt.config.loading import describe

    parts = ["# Settings", "What `bayeshunt settings` lists: every key of an experiment's file and of a robot's."]
    for kind in ("experiment", "robot"):
        rows = describe(kind)
        keys = list(rows[0])
        table = ["| " + " | ".join(keys) + " |", "|" + " --- |" * len(keys)]
        table += ["| " + " | ".join(f"`{row[k]}`" if k == "key" else escaped(row[k]) for k in keys) + " |" for row in rows]
        parts += [f"## {kind.capitalize()}", "\n".join(table)]
    return {"reference/settings.md": "\n\n".join(parts) + "\n"}


def catalogue_pages() -> dict[str, Any]:
    """What there is to choose from, with pictures."""
    robots, robot_pictures = robots_page()
    planners, planner_pictures = planners_page()
    return {"catalogue/robots.md": robots, "catalogue/planners.md": planners, "catalogue/prey.md": prey_page(),
            "catalogue/presets.md": presets_page(), **robot_pictures, **planner_pictures}  # fmt: skip


def robots_page() -> tuple[str, dict[str, bytes]]:
    """Robots that ship: what they are, and where their gaits take them."""
    from bayeshunt.config.loading import preset_names
    from bayeshunt.views import figures

    parts = ["# Robots", "A robot is a TOML file: a body and its gaits. Start your own from one of these:"
             " `bayeshunt robots khepera --toml > mine.toml`."]  # fmt: skip
    pictures = {}
    for name in preset_names("robots"):
        robot = bh.load_robot(name)
        parts += [f"## {name}", robot.description or robot.name,
                  f"Body: {1000 * robot.gaits.body_length:.0f} mm, moved by `{robot.body.drive}`;"
                  f" {len(robot.gaits)} gaits of {robot.gait_duration:g} s: {', '.join(robot.gaits.names)}."]  # fmt: skip

        def draw(robot: Any = robot) -> Any:
            frame = bh.babble(robot, 30 * len(robot.gaits), seed=0)
            return figures.gait_outcomes(bh.ForwardModel.fit(frame, robot.gaits))

        picture = drawn(f"robot {name}", draw)
        if picture:
            pictures[f"catalogue/robot_{name}.png"] = picture
            parts.append(f"![Where each gait of {name} takes it, and the heading after it](robot_{name}.png)")
    return "\n\n".join(parts) + "\n", pictures


def planners_page() -> tuple[str, dict[str, bytes]]:
    """Planners that ship: what each does, its settings, a hunt."""
    from bayeshunt.planners.catalogue import describe_planner
    from bayeshunt.planners.registry import planner_names

    facts = [describe_planner(name) for name in planner_names()]
    parts = ["# Planners", "`bayeshunt planners NAME` says the same; settings go into a file or after"
             " `--set planner.NAME.KEY=VALUE`. \\*: given more than it learns within the run. Pictures: the same hunt of"
             " preset `paper`, walled, bearing 4 rad, seed 8.",
             "| planner | what it does |\n| --- | --- |\n"
             + "\n".join(f"| [`{f.name}`](#{f.name}){STAR[not f.ab_initio]} | {escaped(f.summary)} |" for f in facts)]  # fmt: skip
    pictures = {}
    for f in facts:
        parts += [f"## {f.name} {{ #{f.name} }}", f.summary + ".", plain(f.details)]
        if f.needs:
            parts.append("Needs: " + "; ".join(f"`{key}`, made by `{maker}`" for key, maker in f.needs.items()) + ".")
        if f.settings:
            rows = [f"| `{s.name}` | {escaped(s.default)} | {escaped(' '.join(filter(None, [s.kind, s.range])))} |"
                    f" {escaped(s.meaning)} |" for s in f.settings]  # fmt: skip
            parts.append("\n".join(["| setting | default | takes | meaning |", "| --- | --- | --- | --- |", *rows]))
        if f.reference:
            parts.append(f"Reference: {f.reference}.")
        picture = None if f.needs or f.needs_future else drawn(f"planner {f.name}", lambda name=f.name: hunt_of(name))
        if picture:
            pictures[f"catalogue/planner_{f.name}.png"] = picture
            parts.append(f"![The paths of a hunt of {f.name}](planner_{f.name}.png){{ width=320 }}")
    return "\n\n".join(part for part in parts if part) + "\n", pictures


def plain(text: str) -> str:
    """A docstring's text as Markdown."""
    import re

    return re.sub(r":[a-z]+:`~?\.?([^`]+)`", r"`\1`", textwrap.dedent(text)).replace("``", "`")


def hunt_of(name: str) -> Any:
    """The picture of one hunt."""
    from bayeshunt.experiments.preparation import learn_rooms, prepare_planner
    from bayeshunt.experiments.protocol import learn_model
    from bayeshunt.views.figures.hunts import hunts

    settings = bh.load_experiment("paper")
    if not _MODELS:
        _MODELS.append(learn_model(settings, 0))
    rooms = learn_rooms(settings, [name], {"walled": settings.arenas["walled"]}, 0, _MODELS[0])
    planner = prepare_planner(name, _MODELS[0], settings, rooms, "walled")
    return hunts([bh.hunt(settings, planner, arena="walled", theta=4.0, seed=8)])


_MODELS: list[Any] = []


def drawn(key: str, draw: Any) -> bytes | None:
    """A figure as PNG, kept; None where what it needs is not installed, or without pictures."""
    kept = gallery.cached(key, ".png")
    if kept.exists():
        return kept.read_bytes()
    if os.environ.get("BAYESHUNT_GALLERY") == "sources":
        return None
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    try:
        figure = draw()
    except (bh.BayesHuntError, ImportError) as error:
        print(f"no picture of {key}: {error}")
        return None
    file = io.BytesIO()
    figure.savefig(file, dpi=120, format="png")
    pyplot.close("all")
    kept.write_bytes(file.getvalue())
    return file.getvalue()


def prey_page() -> str:
    """Behaviours of prey."""
    from bayeshunt.worlds.prey import behaviours

    rows = [f"| `{name}` | {first_line(kind)} |" for name, kind in behaviours._BEHAVIOURS.items()]
    return "\n".join(["# Prey", "", "`--set prey.behaviour=NAME`, or `behaviour = \"NAME\"` under `[prey]`; one of your own:",
                      "`bh.register_prey`.", "", "| behaviour | what it does |", "| --- | --- |", *rows, ""])  # fmt: skip


def presets_page() -> str:
    """Experiments that ship."""
    from bayeshunt.config.loading import load_experiment, preset_names

    parts = ["# Presets", "`bayeshunt evaluate --preset NAME`; `bayeshunt presets NAME --toml` prints one to start yours from."]
    for name in preset_names():
        settings = load_experiment(name)
        parts += [f"## {name}", settings.note or settings.name,
                  f"Robot `{settings.robot.name}`; arenas {', '.join(settings.arenas)}; planners {', '.join(settings.planners)}."]  # fmt: skip
    return "\n\n".join(parts) + "\n"
