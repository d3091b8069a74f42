"""Text stands out from its ground by 4.5 to 1 or more, in both themes: WCAG 2.2, 1.4.3."""

from __future__ import annotations

import itertools
import re

import pytest

from bayeshunt.views import theme
from bayeshunt.views.pages.page import asset

LEAST = 4.5


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


@pytest.mark.parametrize("shade", [0, 1], ids=["light", "dark"])
def test_displays(shade: int) -> None:
    colours = {name: solid(values[shade]) for name, values in theme.COLOURS.items()}
    pairs = [*itertools.product(["ink", "faint"], ["paper", "panel"]), ("ink", "heat")]
    assert {pair: c for pair in pairs if (c := contrast(*map(colours.get, pair))) < LEAST} == {}


@pytest.mark.parametrize("shade", [0, 1], ids=["light", "dark"])
def test_pages(shade: int) -> None:
    colours = dict(re.findall(r"--([\w-]+): (#\w{6})", re.findall(r":root \{(.*?)\}", asset("page.css"), re.S)[shade]))
    text = itertools.product(["ink", "muted", "good", "bad"], ["ground", "card", "soft", "field", "new"])
    pairs = [*text, ("card", "hunter"), ("hunter", "ground"), ("prey", "field")]
    assert {pair: c for pair in pairs if (c := contrast(*map(colours.get, pair))) < LEAST} == {}


def test_no_heading_is_empty_and_what_scrolls_has_a_name(thing) -> None:
    html = thing._repr_html_()
    assert not re.search(r"<th[^>]*></th>", html)
    for box in re.findall(r"<[^>]*tabindex[^>]*>", html):
        assert 'aria-label="' in box
