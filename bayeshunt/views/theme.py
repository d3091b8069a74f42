"""Colours and style sheets of pages, notebook displays and figures: one palette in which a colour has a meaning.

Blue is the hunter, orange the prey, purple what is chosen, green a catch, slate a probability; planners have colours
that are none of these. Gaits go from grey (straight) by hue as they turn, cool to the left and warm to the right:
every pair stays apart for colour-blind readers too (CIE 1976 distance above 20 as protanopes and deuteranopes see
them), in the light and in the dark theme, where each has a colour of its own. More gaits than that have the colours
again, striped. Text has a contrast of 4.5 to 1 or more, marks of 3 to 1.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from bayeshunt.core.errors import ZeroCountError
from bayeshunt.core.geometry import wrap
from bayeshunt.models.body.forward import ForwardModel

__all__ = [
    "COLOURS", "GAITS", "PLANNERS", "gait_colours", "gait_names", "gait_stripes", "gait_variables", "palette",
    "stripes", "style",
]  # fmt: skip

#: Light and dark values of every colour by its meaning; heat and glow as red, green, blue.
COLOURS = {
    "ink": ("#1b1f24", "#e8eaed"),
    "faint": ("#55616f", "#a3afbd"),
    "paper": ("#ffffff", "#15181c"),
    "ground": ("#f6f7f9", "#101317"),
    "panel": ("#f0f3f6", "#20252b"),
    "line": ("#d5dae0", "#3a424c"),
    "grid": ("#e9edf2", "#242a31"),
    "wall": ("#7c8896", "#8a97a6"),
    "heat": ("150, 190, 220", "45, 90, 125"),
    "bar": ("#64788f", "#8296ab"),
    "chosen": ("#7b2d8e", "#d8a0f5"),
    "glow": ("222, 190, 235", "96, 52, 120"),
    "hunter": ("#0067a5", "#56b4e9"),
    "prey": ("#b54a00", "#f0a030"),
    "good": ("#12703f", "#6fd39f"),
    "bad": ("#a3262a", "#f59a9a"),
    "new": ("#fdf0d9", "#40321a"),
}
#: Light and dark colour of each planner, in the order in which they are shown; more planners start over.
PLANNERS = (
    ("#0b7a5c", "#5ccfab"), ("#b3225f", "#f58cb5"), ("#6b6400", "#d6c94f"), ("#24284f", "#e4e6fb"),
    ("#8c6d1f", "#c9ad62"), ("#4a7a12", "#9ccf7c"), ("#7a4a2b", "#c99b7a"), ("#717a86", "#8f99a5"),
)  # fmt: skip
#: Gaits by how they turn, each list from the one that turns least: light and dark, as in :data:`COLOURS`.
GAITS = {
    "straight": (("#4b4b4b", "#e1e1e1"), ("#1e1e0f", "#696969")),
    "left": (("#2d875a", "#00ffa5"), ("#2d6987", "#5ad2ff"), ("#3c4bff", "#4b69ff"), ("#9600b4", "#a55ac3")),
    "right": (("#96964b", "#ffe11e"), ("#783c1e", "#ff964b"), ("#f00f00", "#d21e2d"), ("#ff00b4", "#f069b4")),
}
#: Up to this bearing of its end [rad] a gait counts as straight.
_STRAIGHT_UP_TO = 0.05
#: Along an arc the heading is twice the bearing, up to this [rad].
_ARC = 1.0

#: What stands above a display under each theme of a notebook: light and dark of JupyterLab, VS Code, marimo.
_THEMES = (
    ('[data-jp-theme-light="true"]', '[data-jp-theme-light="false"]'),
    ("body.vscode-light", "body.vscode-dark"),
    ("body.light-theme", "body.dark-theme"),
    (".marimo>.light", ".marimo>.dark"),
)
#: Backgrounds of a box that scrolls: a shadow at every edge beyond which there is more. A cover moves with the content
#: and hides the shadow where that ends (L. Verou, Pure CSS scrolling shadows with background-attachment: local, 2012).
_EDGES = ",".join(
    f"linear-gradient(to {away},{colours}) {edge}/{size} no-repeat {attached}"
    for colours, deep, attached in (
        ("var(--bh-paper) 10px,transparent", "26px", "local"),
        ("color-mix(in srgb,var(--bh-wall) 60%,transparent),transparent", "10px", "scroll"),
    )
    for edge, away, size in (
        ("left", "right", f"{deep} 100%"),
        ("right", "left", f"{deep} 100%"),
        ("top", "bottom", f"100% {deep}"),
        ("bottom", "top", f"100% {deep}"),
    )
)

_RULES = """
.bh{background:var(--bh-paper);color:var(--bh-ink);border:1px solid var(--bh-line);border-radius:8px;
 padding:12px 14px;margin:2px 0 8px;max-width:980px;position:relative;box-sizing:border-box;
 font:13px/1.45 system-ui,-apple-system,"Segoe UI",Roboto,sans-serif;text-align:left}
.bh *{box-sizing:border-box}
.bh .bh-title{font-weight:600;font-size:15px;margin:0 0 2px}
.bh .bh-sub{color:var(--bh-faint);margin:0 0 10px}
.bh .bh-facts{display:flex;flex-wrap:wrap;gap:6px 22px;margin:0 0 10px;padding:0;width:auto}
.bh .bh-facts div{display:flex;flex-direction:column}
.bh .bh-facts dt,.bh .bh-facts dd{float:none;width:auto}
.bh .bh-facts dt{color:var(--bh-faint);font-size:11.5px;font-weight:400}
.bh .bh-facts dd{margin:0;font-variant-numeric:tabular-nums;overflow-wrap:anywhere}
.bh svg{display:block;max-width:100%;height:auto}
.bh svg text{fill:var(--bh-ink);font:12px system-ui,-apple-system,"Segoe UI",Roboto,sans-serif}
.bh svg .bh-faint{fill:var(--bh-faint)}
.bh .bh-scroll{overflow:auto;max-height:26em;width:fit-content;max-width:100%;
 border:1px solid var(--bh-line);border-radius:6px;background:var(--bh-edges),var(--bh-paper)}
.bh table{border-collapse:separate;border-spacing:0;margin:0;font-size:12px;font-variant-numeric:tabular-nums;
 color:var(--bh-ink);background:none;border:0;table-layout:auto}
.bh th,.bh td{padding:2px 8px;text-align:right;white-space:nowrap;border:0;
 border-bottom:1px solid var(--bh-panel);max-width:none;color:var(--bh-ink)}
.bh tbody tr,.bh tbody tr:nth-child(odd),.bh tbody tr:hover{background:none}
.bh thead th{position:sticky;top:0;z-index:2;background:var(--bh-panel);font-weight:600;vertical-align:bottom;
 border-bottom:1px solid var(--bh-line)}
.bh thead td{position:sticky;top:0;z-index:2;background:var(--bh-panel);border-bottom:1px solid var(--bh-line)}
.bh tbody th{position:sticky;left:0;z-index:1;background:var(--bh-panel);font-weight:400;text-align:left}
.bh thead th:first-child{left:0;z-index:3;text-align:left}
.bh .bh-left{text-align:left}
.bh .bh-heat td{background:rgba(var(--bh-heat),var(--p,0))}
.bh tr.bh-none:not(:hover) th,.bh tr.bh-none:not(:hover) td{padding-top:0;padding-bottom:0;border-bottom:0;
 line-height:2px;font-size:0}
.bh .bh-heat td:hover,.bh .bh-heat td:has(input:checked){outline:2px solid var(--bh-chosen);outline-offset:-2px}
.bh .bh-heat td:has(input:focus-visible){outline:3px solid var(--bh-hunter);outline-offset:-3px}
.bh .bh-heat td:has(label){padding:0}
.bh .bh-heat label{display:block;padding:2px 8px;cursor:pointer}
.bh .bh-heat label input{appearance:none;width:0;height:0;margin:0;padding:0;border:0;outline:0;vertical-align:top}
.bh .bh-cell{position:relative}
.bh .bh-cell button{all:unset;display:none;position:absolute;inset:0 0 0 auto;width:14px;text-align:center;
 cursor:pointer;background:var(--bh-chosen);color:var(--bh-paper);box-sizing:border-box}
.bh td:hover>.bh-cell button,.bh .bh-cell:has(input:checked) button,.bh .bh-cell button:focus-visible{display:block}
.bh .bh-cell:has(input:checked) button{width:100%;opacity:0}
.bh .bh-cell:has(input:checked) button:focus-visible{opacity:1}
.bh .bh-rows{list-style:none;margin:0;padding:0;font-variant-numeric:tabular-nums}
.bh .bh-rows span{display:inline-block;min-width:4.5em;color:var(--bh-faint)}
.bh .bh-signed .bh-marked{outline:2px solid var(--bh-ink);outline-offset:-2px}
.bh .bh-readout{position:relative;padding-bottom:24px}
@media(max-width:620px){.bh .bh-readout{padding-bottom:58px}}
.bh .bh-readout::before{content:attr(data-hint);color:var(--bh-faint);
 position:absolute;left:0;top:calc(100% - 20px);font-size:12px}
@media(max-width:620px){.bh .bh-readout::before{top:calc(100% - 54px)}}
.bh .bh-readout:has(td:hover)::before,.bh .bh-readout:has(input:checked)::before{content:""}
.bh .bh-readout td:hover::after,.bh .bh-readout:not(:has(td:hover)) td:has(input:checked)::after{
 content:attr(title);position:absolute;left:0;bottom:0;font-size:12px;
 color:var(--bh-ink);pointer-events:none}
.bh .bh-zero{color:var(--bh-faint)}
.bh .bh-n,.bh .bh-i{display:none}
.bh .bh-table:has(.bh-switch input:checked) .bh-n{display:inline}
.bh .bh-table:has(.bh-switch input:checked) .bh-p{display:none}
.bh .bh-table:has(.bh-limits input:checked) .bh-i{display:block;font-size:11px}
.bh .bh-switch,.bh .bh-limits{display:inline-flex;gap:6px;align-items:center;margin:0 12px 6px 0;cursor:pointer}
.bh details{margin:6px 0}
.bh summary{cursor:pointer}
.bh .bh-lit,.bh tr.bh-lit th,.bh tr.bh-lit td{background:rgba(var(--bh-glow),.45)}
.bh .bh-lit{font-weight:600}
.bh tr.bh-lit th,.bh tr.bh-lit td{font-weight:600}
.bh .bh-bar{display:block;height:12px;border-radius:2px;background:var(--bh-bar);min-width:1px}
.bh tr.bh-lit .bh-bar{background:var(--bh-chosen)}
.bh .bh-track{width:220px}
.bh .bh-strips{display:grid;grid-template-columns:max-content minmax(0,420px);gap:2px 6px;align-items:center;
 margin:0 0 6px;font-size:12px;line-height:12px;color:var(--bh-faint);text-align:right}
.bh .bh-strips svg{width:100%;height:12px;background:var(--bh-panel)}
@media(max-width:520px){.bh .bh-bars .bh-track{min-width:72px}.bh .bh-bars th,.bh .bh-bars td{padding:2px 4px}
 .bh .bh-bars thead th:last-child{white-space:normal}}
.bh .bh-scale{position:relative;min-height:12px}
.bh .bh-whisker{position:absolute;top:5px;height:2px;min-width:2px;background:currentColor}
.bh .bh-tornado{display:inline-flex;max-width:calc(100% - 20px);flex-wrap:wrap;
 gap:2px 10px;align-items:center;vertical-align:middle}
.bh .bh-phone{display:none}
@media(max-width:520px){.bh .bh-phone{display:block}.bh .bh-desk{display:none}}
.bh .bh-scroll+.bh-scroll{margin-top:10px}
.bh th button{all:unset;cursor:pointer;text-decoration:underline dotted;text-underline-offset:3px}
.bh th button:hover{text-decoration:underline}
.bh button:focus-visible{outline:3px solid var(--bh-hunter);outline-offset:1px;border-radius:3px}
.bh .bh-side{position:fixed;inset:0 0 0 auto;width:min(420px,100%);height:100%;max-width:none;max-height:none;margin:0;
 padding:12px 14px;border:0;border-left:1px solid var(--bh-line);background:var(--bh-paper);color:var(--bh-ink);
 overflow:auto;box-shadow:0 0 24px rgba(0,0,0,.25)}
@media(max-width:620px){.bh .bh-side{inset:auto 0 0 0;width:100%;height:auto;max-height:66vh}}
.bh .bh-head{margin-bottom:8px;display:flex;gap:10px;justify-content:space-between;align-items:flex-start}
.bh .bh-crumbs{display:flex;flex-wrap:wrap;align-items:center;gap:2px 6px;list-style:none;margin:0;padding:0;
 font-weight:600}
.bh .bh-crumbs li+li::before{content:"› "}
.bh .bh-side button{font:inherit;color:inherit;padding:1px 8px;min-height:24px;background:var(--bh-panel);
 border:1px solid var(--bh-line);border-radius:6px;cursor:pointer}
.bh .bh-side p{margin:8px 0}
.bh .bh-two{display:flex;flex-wrap:wrap;gap:16px;align-items:flex-start}
.bh .bh-two>*{min-width:0}
.bh .bh-tree details{margin:0 0 0 18px;border-left:1px solid var(--bh-line)}
.bh .bh-tree .bh-leaf{margin:0 0 0 18px;padding:1px 6px 1px 20px;border-left:1px solid var(--bh-line)}
.bh .bh-tree summary{padding:1px 6px}
.bh .bh-tree .bh-value{color:var(--bh-faint);font-variant-numeric:tabular-nums;font-weight:400;margin-left:8px}
@media(max-width:520px){.bh .bh-tree details,.bh .bh-tree .bh-leaf{margin-left:6px}
 .bh .bh-tree .bh-leaf{padding-left:10px}}
.bh .bh-tree .bh-lit .bh-value{color:var(--bh-ink)}
.bh .bh-note{color:var(--bh-faint);font-size:12px;margin:6px 0 0}
"""


def palette(selector: str) -> str:
    """Return the rules that give ``selector`` all colours as ``--bh-...``, light or dark as the system or notebook is.

    JupyterLab's, VS Code's and marimo's own themes win over the system's; marimo's widgets stand in a shadow root.
    """
    light, dark = (_variables(shade) for shade in (0, 1))
    chosen = [
        ",".join(f"{above} {selector}" for above in theme) + f"{{{values}}}\n"
        for theme, values in zip(zip(*_THEMES, strict=True), (light, dark), strict=True)
    ]
    return f"{selector}{{{light}}}\n@media (prefers-color-scheme:dark){{{selector}{{{dark}}}}}\n" + "".join(chosen)


def style() -> str:
    """Return the style sheet of every display.

    Every rule names its root thrice, so that it wins over the sheets of the notebooks around it.
    """
    return palette(".bh") + _RULES.replace(".bh ", ".bh.bh.bh ")


def _variables(shade: int) -> str:
    values = {name: pair[shade] for name, pair in COLOURS.items()}
    values |= {f"planner-{index}": pair[shade] for index, pair in enumerate(PLANNERS, start=1)}
    values |= {f"{side}-{rank}": pair[shade] for side, pairs in GAITS.items() for rank, pair in enumerate(pairs)}
    scheme = "color-scheme:" + ("light", "dark")[shade]
    return ";".join([scheme, *(f"--bh-{name}:{value}" for name, value in values.items()), f"--bh-edges:{_EDGES}"])


def gait_names(turns: Iterable[float]) -> list[tuple[str, int]]:
    """Return the side and the rank on it of each gait by how far it turns [rad clockwise], as keys of :data:`GAITS`.

    NaN, where nobody knows, counts as straight; where a side has more gaits than colours it starts over, striped.
    """
    return [(side, rank % len(GAITS[side])) for side, rank in _ranked(turns)]


def gait_stripes(turns: Iterable[float]) -> list[int]:
    """Return how many stripes tell each gait from one of the same colour: none but where a side has started over."""
    return [rank // len(GAITS[side]) for side, rank in _ranked(turns)]


def _ranked(turns: Iterable[float]) -> list[tuple[str, int]]:
    """The side of each gait, and how many of that side turn less."""
    angles = np.nan_to_num(np.array(list(turns), dtype=float))
    sides = np.where(np.abs(angles) <= _STRAIGHT_UP_TO, "straight", np.where(angles < 0, "left", "right"))
    names = [("", 0)] * len(angles)
    for side in GAITS:
        chosen = np.flatnonzero(sides == side)
        for rank, index in enumerate(chosen[np.argsort(np.abs(angles[chosen]), kind="stable")].tolist()):
            names[index] = (side, rank)
    return names


def gait_colours(model: ForwardModel) -> list[str]:
    """Return the colour of every gait of a model in table order, for figures on white."""
    return [GAITS[side][rank][0] for side, rank in gait_names(_turns(model))]


def gait_variables(model: ForwardModel) -> list[str]:
    """Return the same for drawings that follow the theme: CSS variables."""
    return [f"var(--bh-{side}-{rank})" for side, rank in gait_names(_turns(model))]


def stripes(model: ForwardModel) -> list[int]:
    """Return how many stripes go with each of those colours."""
    return gait_stripes(_turns(model))


def _turns(model: ForwardModel) -> list[float]:
    return [_turn(model, i) for i in range(len(model.gaits))]


def _turn(model: ForwardModel, gait: int) -> float:
    """Bearing of a gait's mean end: half of what it turns, and unlike its heading not wrapped before a full turn.

    Where it does not move along an arc, as legs that turn on the spot and slide, its heading says which way it turns.
    """
    try:
        end = model.predict(model.gaits[gait])
    except ZeroCountError:
        return 0.0
    along = end.distance > 0.1 * (model.gaits.body_length or 0.0) and abs(wrap(2 * end.angle - end.heading)) < _ARC
    return float(end.angle if along else end.heading)
