"""Robots, planners, prey and presets: what there is to choose from, with pictures."""

from __future__ import annotations

import io
import os
from functools import cache
from typing import Any

import gallery
from texts import escaped, first_line, plain

import bayeshunt as bh

STAR = ("", " \\*")


def pages() -> dict[str, Any]:
    """What there is to choose from, with pictures."""
    robots, robot_pictures = robots_page()
    planners, planner_pictures = planners_page()
    return {
        "catalogue/robots.md": robots,
        "catalogue/planners.md": planners,
        "catalogue/prey.md": prey_page(),
        "catalogue/presets.md": presets_page(),
        **robot_pictures,
        **planner_pictures,
    }


def robots_page() -> tuple[str, dict[str, bytes]]:
    """Robots that ship: what they are, and where their gaits take them."""
    from bayeshunt.config.loading import preset_names
    from bayeshunt.views import figures

    parts = [
        "# Robots",
        "A robot is a TOML file: a body and its gaits. Start your own from one of these:"
        " `bayeshunt robots khepera --toml > mine.toml`.",
    ]
    pictures = {}
    for name in preset_names("robots"):
        robot = bh.load_robot(name)
        parts += [
            f"## {name}",
            robot.description or robot.name,
            f"Body: {1000 * robot.gaits.body_length:.0f} mm, moved by `{robot.body.drive}`;"
            f" {len(robot.gaits)} gaits of {robot.gait_duration:g} s: {', '.join(robot.gaits.names)}.",
        ]

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
    parts = [
        "# Planners",
        "`bayeshunt planners NAME` says the same; settings go into a file or after"
        " `--set planner.NAME.KEY=VALUE`. \\*: given more than it learns within the run. Pictures: one hunt of"
        " preset `paper`, walled, bearing 4 rad, seed 8.",
        "| planner | what it does |\n| --- | --- |\n"
        + "\n".join(f"| [`{f.name}`](#{f.name}){STAR[not f.ab_initio]} | {escaped(f.summary)} |" for f in facts),
    ]
    pictures = {}
    for f in facts:
        parts += [f"## {f.name} {{ #{f.name} }}", f.summary + ".", plain(f.details)]
        if f.needs:
            parts.append("Needs: " + "; ".join(f"`{key}`, made by `{maker}`" for key, maker in f.needs.items()) + ".")
        if f.settings:
            rows = [
                f"| `{s.name}` | {escaped(s.default)} | {escaped(' '.join(filter(None, [s.kind, s.range])))} |"
                f" {escaped(s.meaning)} |"
                for s in f.settings
            ]
            parts.append("\n".join(["| setting | default | takes | meaning |", "| --- | --- | --- | --- |", *rows]))
        if f.reference:
            parts.append(f"Reference: {f.reference}.")
        picture = None if f.needs or f.needs_future else drawn(f"planner {f.name}", lambda name=f.name: hunt_of(name))
        if picture:
            pictures[f"catalogue/planner_{f.name}.png"] = picture
            parts.append(f"![The paths of a hunt of {f.name}](planner_{f.name}.png){{ width=320 }}")
    return "\n\n".join(part for part in parts if part) + "\n", pictures


def hunt_of(name: str) -> Any:
    """The picture of one hunt."""
    from bayeshunt.experiments.preparation import learn_rooms, prepare_planner
    from bayeshunt.views.figures.hunts import hunts

    settings, model = bh.load_experiment("paper"), paper_model()
    rooms = learn_rooms(settings, [name], {"walled": settings.arenas["walled"]}, 0, model)
    planner = prepare_planner(name, model, settings, rooms, "walled")
    return hunts([bh.hunt(settings, planner, arena="walled", theta=4.0, seed=8)])


@cache
def paper_model() -> Any:
    """The model of preset ``paper``, seed 0."""
    from bayeshunt.experiments.protocol import learn_model

    return learn_model(bh.load_experiment("paper"), 0)


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

    rows = [f"| `{name}` | {first_line(kind)} |" for name, kind in behaviours.behaviours().items()]
    return "\n".join(
        [
            "# Prey",
            "",
            '`--set prey.behaviour=NAME`, or `behaviour = "NAME"` under `[prey]`; one of your own:',
            "`bh.register_prey`.",
            "",
            "| behaviour | what it does |",
            "| --- | --- |",
            *rows,
            "",
        ]
    )


def presets_page() -> str:
    """Experiments that ship."""
    from bayeshunt.config.loading import load_experiment, preset_names

    parts = [
        "# Presets",
        "`bayeshunt evaluate --preset NAME`; `bayeshunt presets NAME --toml` prints one to start yours from.",
    ]
    for name in preset_names():
        settings = load_experiment(name)
        parts += [
            f"## {name}",
            settings.note or settings.name,
            f"Robot `{settings.robot.name}`; arenas {', '.join(settings.arenas)};"
            f" planners {', '.join(settings.planners)}.",
        ]
    return "\n\n".join(parts) + "\n"
