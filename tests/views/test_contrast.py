"""Text stands out from its ground by 4.5 to 1 or more, marks by 3 to 1, in both themes: WCAG 2.2, 1.4.3 and 1.4.11."""

from __future__ import annotations

import itertools
import math
import re

import numpy as np
import pytest

from bayeshunt.views import theme
from bayeshunt.views.pages.page import asset
from bayeshunt.views.pages.replay import SCRIPTS

TEXT, MARKS = 4.5, 3.0


def luminance(colour: str) -> float:
    """Relative luminance of "#rrggbb"."""
    shares = [int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5)]
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in shares]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def contrast(one: str, two: str) -> float:
    darker, lighter = sorted(map(luminance, (one, two)))
    return (lighter + 0.05) / (darker + 0.05)


def solid(colour: str) -> str:
    """A colour of the theme as "#rrggbb"; some are written as "red, green, blue"."""
    return colour if colour.startswith("#") else "#" + "".join(f"{int(part):02x}" for part in colour.split(","))


def test_the_measure_itself() -> None:
    assert contrast("#000000", "#ffffff") == pytest.approx(21)
    assert contrast("#777777", "#ffffff") == pytest.approx(4.48, abs=0.005)


@pytest.fixture(params=[0, 1], ids=["light", "dark"])
def colours(request) -> dict[str, str]:
    """Every colour of one theme by name."""
    shade = request.param
    found = {name: solid(values[shade]) for name, values in theme.COLOURS.items()}
    found |= {f"planner {i}": values[shade] for i, values in enumerate(theme.PLANNERS)}
    return found | {f"{side} {i}": v[shade] for side, row in theme.GAITS.items() for i, v in enumerate(row)}


def too_faint(colours, pairs, least) -> dict:
    return {pair: c for pair in pairs if (c := contrast(*map(colours.get, pair))) < least}


def test_text_stands_out(colours) -> None:
    text = itertools.product(["ink", "faint"], ["paper", "ground", "panel", "new"])
    coloured = itertools.product(["hunter", "prey", "good", "bad", "chosen"], ["paper", "ground"])
    others = [("ink", "heat"), ("ink", "glow"), ("good", "panel"), ("bad", "panel")]
    assert too_faint(colours, [*text, *coloured, *others], TEXT) == {}


def test_marks_stand_out(colours) -> None:
    gaits = [name for name in colours if name.startswith(("planner", "straight", "left", "right"))]
    assert len(gaits) == 18
    marks = itertools.product(["bar", "chosen", "hunter", "prey", "good", "bad", "wall", *gaits], ["paper"])
    assert too_faint(colours, marks, MARKS) == {}


def test_a_planner_has_neither_the_colour_of_a_robot_nor_of_what_is_chosen(colours) -> None:
    for name in (name for name in colours if name.startswith("planner")):
        assert min(apart(colours[name], colours[other]) for other in ("hunter", "prey", "chosen")) > 20, name


def apart(one: str, two: str) -> float:
    """CIE 1976 distance of two colours."""
    lab = []
    for colour in (one, two):
        shares = np.array([int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5)])
        linear = np.where(shares <= 0.04045, shares / 12.92, ((shares + 0.055) / 1.055) ** 2.4)
        to_xyz = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])
        x, y, z = np.cbrt(to_xyz @ linear / to_xyz.sum(axis=1))  # dark colours aside
        lab.append(np.array([116 * y, 500 * (x - y), 200 * (y - z)]))
    return float(np.linalg.norm(lab[0] - lab[1]))


def test_one_palette_serves_displays_pages_and_the_explorer() -> None:
    """No sheet names a colour of its own, and every colour that one uses is in the palette."""
    known = set(re.findall(r"--bh-([\w-]+):", theme.palette(".x")))
    for name in ("page.css", "player.css", "report.css", "explorer.css", "network.css"):
        sheet = asset(name)
        assert not re.search(r"#[0-9a-f]{3,6}\b", sheet, re.I), name
        assert set(re.findall(r"var\(--bh-([\w-]+)\)", sheet)) <= known, name
    drawn = set(re.findall(r'ink\("([\w-]+)"\)', "".join(map(asset, SCRIPTS))))
    assert drawn <= known


def test_the_ink_of_a_display_never_comes_without_its_ground() -> None:
    """Ink that follows a dark system on a page that stays light cannot be read."""
    for root, sheet in ((".bh{", theme.style()), (".bh-explorer {", asset("explorer.css"))):
        rules = [
            body for body in sheet.split(root)[1:] if "color:" in (own := body.split("}")[0]) and "--bh-ink:" not in own
        ]
        assert rules
        assert all("background:" in rule.split("}")[0] for rule in rules)


def test_gaits_of_one_side_differ_and_go_by_how_much_they_turn(khepera_model) -> None:
    names = dict(zip(khepera_model.gaits.names, theme.gait_variables(khepera_model), strict=True))
    left = [names[name] for name in ("slow left", "wide left", "tight left", "spin left")]
    assert left == [f"var(--bh-left-{i})" for i in range(4)]
    assert [names[name] for name in ("slow right", "wide right", "tight right", "spin right")] == [
        f"var(--bh-right-{i})" for i in range(4)
    ]
    assert {names["straight"], names["slow straight"]} == {"var(--bh-straight-0)", "var(--bh-straight-1)"}
    assert theme.stripes(khepera_model) == [0] * 10
    assert theme.gait_names([math.nan, 0.3, 0.1, *[0.2] * 3])[:3] == [("straight", 0), ("right", 0), ("right", 0)]


def test_more_gaits_than_colours_are_told_apart_by_stripes() -> None:
    turns = [0.0, 0.01, -0.02, 0.03, 0.04, *[0.1 * k for k in range(1, 10)], *[-0.1 * k for k in range(1, 10)]]
    looks = list(zip(theme.gait_names(turns), theme.gait_stripes(turns), strict=True))
    assert len(set(looks)) == len(turns)
    assert looks[:5] == [(("straight", 0), 0), (("straight", 1), 0), (("straight", 0), 1), (("straight", 1), 1),
                         (("straight", 0), 2)]  # fmt: skip


def test_no_heading_is_empty_and_what_scrolls_has_a_name(thing) -> None:
    html = thing._repr_html_()
    assert not re.search(r"<th[^>]*></th>", html)
    for box in re.findall(r"<[^>]*tabindex[^>]*>", html):
        assert 'aria-label="' in box
