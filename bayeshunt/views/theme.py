"""Colours and style sheets that pages, notebook displays and figures share.

Hunter and prey, and the gaits, keep their colour everywhere. Robots are coloured after Okabe and Ito
(2008); the gaits' colours were chosen so that every pair stays apart for colour-blind readers too (CIE
1976 distance above 20 as protanopes and deuteranopes see them).
"""

from __future__ import annotations

#: Light and dark values of every colour: ink, paper, lines, heat (as red, green, blue), robots, accent.
COLOURS = {
    "ink": ("#1b1f24", "#e8eaed"),
    "faint": ("#5b636d", "#9aa4b0"),
    "paper": ("#ffffff", "#15181c"),
    "panel": ("#f4f6f8", "#20252b"),
    "line": ("#d5dae0", "#3a424c"),
    "heat": ("86, 180, 233", "0, 104, 164"),
    "bar": ("#4a90c2", "#5aa9e0"),
    "accent": ("#b04a00", "#ffb454"),
    "glow": ("255, 196, 120", "140, 80, 10"),
    "hunter": ("#0072b2", "#56b4e9"),
    "prey": ("#d55e00", "#f0a030"),
}
#: One colour per gait, in table order; more gaits start over (and differ by their marker).
GAITS = (
    "#332288", "#e69f00", "#1a85ff", "#dc3220", "#56b4e9", "#882255", "#0072b2", "#a6a6a6", "#e1be6a", "#661100",
)  # fmt: skip

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
 border:1px solid var(--bh-line);border-radius:6px}
.bh table{border-collapse:separate;border-spacing:0;margin:0;font-size:12px;font-variant-numeric:tabular-nums;
 color:var(--bh-ink);background:var(--bh-paper);border:0;table-layout:auto}
.bh th,.bh td{padding:2px 8px;text-align:right;white-space:nowrap;border:0;
 border-bottom:1px solid var(--bh-panel);max-width:none;color:var(--bh-ink)}
.bh tbody tr,.bh tbody tr:nth-child(odd),.bh tbody tr:hover{background:var(--bh-paper)}
.bh thead th{position:sticky;top:0;z-index:2;background:var(--bh-panel);font-weight:600;vertical-align:bottom;
 border-bottom:1px solid var(--bh-line)}
.bh thead td{position:sticky;top:0;z-index:2;background:var(--bh-panel);border-bottom:1px solid var(--bh-line)}
.bh tbody th{position:sticky;left:0;z-index:1;background:var(--bh-panel);font-weight:400;text-align:left}
.bh thead th:first-child{left:0;z-index:3;text-align:left}
.bh .bh-left{text-align:left}
.bh .bh-heat td{background:rgba(var(--bh-heat),var(--p,0))}
.bh .bh-heat td:hover{outline:2px solid var(--bh-accent);outline-offset:-2px}
.bh .bh-readout{position:relative;padding-bottom:24px}
@media(hover:hover){.bh .bh-readout::before{content:attr(data-hint);color:var(--bh-faint);
 position:absolute;left:0;bottom:0;font-size:12px}}
.bh .bh-readout:has(td:hover)::before{content:""}
.bh .bh-readout td:hover::after{content:attr(title);position:absolute;left:0;bottom:0;font-size:12px;
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
.bh tr.bh-lit .bh-bar{background:var(--bh-accent)}
.bh .bh-track{width:220px}
.bh .bh-two{display:flex;flex-wrap:wrap;gap:16px;align-items:flex-start}
.bh .bh-two>*{min-width:0}
.bh .bh-tree details{margin:0 0 0 18px;border-left:1px solid var(--bh-line)}
.bh .bh-tree .bh-leaf{margin:0 0 0 18px;padding:1px 6px 1px 20px;border-left:1px solid var(--bh-line)}
.bh .bh-tree summary{padding:1px 6px}
.bh .bh-tree .bh-value{color:var(--bh-faint);font-variant-numeric:tabular-nums;font-weight:400;margin-left:8px}
.bh .bh-tree .bh-lit .bh-value{color:var(--bh-ink)}
.bh .bh-note{color:var(--bh-faint);font-size:12px;margin:6px 0 0}
"""


def style() -> str:
    """Return the style sheet of every display: light or dark by the system, by JupyterLab or by VS Code."""
    light, dark = (_variables(shade) for shade in (0, 1))
    return (
        f".bh{{{light}}}\n@media (prefers-color-scheme:dark){{.bh{{{dark}}}}}\n"
        # A notebook's own theme wins over the system's.
        f'[data-jp-theme-light="true"] .bh,body.vscode-light .bh{{{light}}}\n'
        f'[data-jp-theme-light="false"] .bh,body.vscode-dark .bh{{{dark}}}{_RULES}'
    )


def _variables(shade: int) -> str:
    scheme = "color-scheme:" + ("light", "dark")[shade]
    return ";".join([scheme, *(f"--bh-{name}:{values[shade]}" for name, values in COLOURS.items())])


def gait_colour(index: int) -> str:
    """Return the colour of the gait at ``index`` in table order."""
    return GAITS[index % len(GAITS)]
