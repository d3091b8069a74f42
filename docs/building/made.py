"""Pages made from the program itself: its public names, its commands, its settings, what there is to choose from."""

from __future__ import annotations

import inspect
from collections.abc import Iterator
from typing import Any

import catalogue
from texts import escaped, first_line

import bayeshunt as bh

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
}


def pages() -> dict[str, Any]:
    """Every page by its place."""
    return {**api_pages(), "reference/commands.md": commands_page(), **settings_pages(), **catalogue.pages()}


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
        "# Python reference",
        "",
        "`import bayeshunt as bh`; these are its public names. SI units: metres, seconds, radians; angles as a robot",
        "sees them are clockwise, poses in the world counter-clockwise. `bh.__version__` is the version.",
        "",
        "| name | what it is |",
        "| --- | --- |",
        f"| [`bh.protocols`](protocols.md) | {first_line(bh.protocols)} |",
    ]
    made = {
        "reference/protocols.md": "# bh.protocols\n\n::: bayeshunt.protocols\n    options: {show_root_heading: false}\n"
    }
    for layer, names in api_names().items():
        parts = [f"# {layer}: {LAYERS.get(layer, '')}".rstrip(": ")]
        for name in names:
            home, attribute = bh._HOMES[name]
            thing = getattr(bh, name)
            target = (
                f"{thing.__module__}.{thing.__qualname__}" if hasattr(thing, "__qualname__") else f"{home}.{attribute}"
            )
            parts.append(
                f'<a id="bh.{name}"></a>\n\n::: {target}\n    options: {{heading: "bh.{name}", toc_label: "{name}"}}'
            )
            lines.append(f"| [`bh.{name}`]({layer}.md#bh.{name}) | {first_line(thing)} |")
        made[f"reference/{layer}.md"] = "\n\n".join(parts) + "\n"
    return {**made, "reference/index.md": "\n".join(lines) + "\n"}


def commands() -> Iterator[tuple[str, Any]]:
    """Every command of the command line with its name as typed."""
    import typer

    import bayeshunt.cli  # noqa: F401  (its commands)
    from bayeshunt.cli.app import app

    def walk(name: str, command: Any) -> Iterator[tuple[str, Any]]:
        yield name, command
        for child in getattr(command, "commands", {}).values():
            yield from walk(f"{name} {child.name}", child)

    yield from walk("bayeshunt", typer.main.get_command(app))


def commands_page() -> str:
    """All commands on one page."""
    found = list(commands())
    parts = [
        "# Commands",
        "Each explains itself with `--help`, prints JSON with `--json` where it has something to say, and exits with 0,"
        " 1 (the work failed) or 2 (the input is wrong: one line with the place and the fix)."
        " `bayeshunt --install-completion` adds completion to your shell.",
        "| command | what it does |\n| --- | --- |\n"
        + "\n".join(f"| [`{name}`](#{anchor(name)}) | {one.get_short_help_str(90)} |" for name, one in found[1:]),
    ]
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
            parts.append("```sh\n" + "\n".join(line.strip() for line in lines) + "\n```")
        else:
            parts.append(escaped(paragraph).replace("[", "\\["))  # brackets of what may be left out are no links
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


def settings_pages() -> dict[str, str]:
    """Every key of a settings file."""
    from bayeshunt.config.loading import describe

    parts = ["# Settings", "What `bayeshunt settings` lists: every key of an experiment's file and of a robot's."]
    for kind in ("experiment", "robot"):
        rows = describe(kind)
        keys = list(rows[0])
        table = ["| " + " | ".join(keys) + " |", "|" + " --- |" * len(keys)]
        table += [
            "| " + " | ".join(f"`{row[k]}`" if k == "key" else escaped(row[k]) for k in keys) + " |" for row in rows
        ]
        parts += [f"## {kind.capitalize()}", "\n".join(table)]
    return {"reference/settings.md": "\n\n".join(parts) + "\n"}
