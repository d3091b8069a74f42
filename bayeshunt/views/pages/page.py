"""Self-contained pages: one file, no network, nothing that a name in the data could smuggle in.

Styles and scripts are put inside the page and allowed by their hash alone, text is escaped by
jinja2, and data travel as JSON that cannot close its own element.
"""

from __future__ import annotations

import base64
import hashlib
import json
import math
from functools import cache
from importlib import resources
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

from bayeshunt.views import theme

if TYPE_CHECKING:
    import jinja2

__all__ = ["asset", "embed", "number", "render"]

_VIEWS = resources.files("bayeshunt") / "views"


def render(template: str, styles: list[str], scripts: list[str], **values: Any) -> str:
    """Return a page made of a template in ``templates/`` and of style and script files in ``assets/``.

    The template finds ``style``, ``script``, ``policy`` (its Content-Security-Policy) and ``version`` (of the package)
    beside ``values``.
    """
    from markupsafe import Markup

    style = "\n" + theme.palette(":root") + "".join(asset(name) for name in styles)
    script = "\n" + "".join(asset(name) for name in scripts)
    policy = (
        f"default-src 'none'; script-src {_allowed(script)}; style-src {_allowed(style)}; "
        "img-src data:; base-uri 'none'; form-action 'none'"
    )
    page = _environment().get_template(template)
    made = {"policy": policy, "style": Markup(style), "script": Markup(script), "version": version("bayeshunt")}
    return page.render(**made, **values)


def embed(data: Any) -> Any:
    """Return JSON that is safe inside a script element: no ``<``, ``>`` or ``&``. Raises ValueError for NaN."""
    from markupsafe import Markup

    text = json.dumps(data, separators=(",", ":"), allow_nan=False)
    for character in "<>&":
        text = text.replace(character, f"\\u{ord(character):04x}")
    return Markup(text)


def asset(name: str) -> str:
    """Return the text of a file in ``assets/``."""
    return (_VIEWS / "assets" / name).read_text(encoding="utf-8")


def number(value: Any, digits: int = 6) -> float | None:
    """Return a float rounded to ``digits`` significant digits, None for a number that is not finite."""
    value = float(value)
    return float(f"{value:.{digits}g}") if math.isfinite(value) else None


def _allowed(text: str) -> str:
    return f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"


@cache
def _environment() -> jinja2.Environment:
    import jinja2

    loader = jinja2.FunctionLoader(lambda name: (_VIEWS / "templates" / name).read_text(encoding="utf-8"))
    return jinja2.Environment(loader=loader, autoescape=True, trim_blocks=True, undefined=jinja2.StrictUndefined)
