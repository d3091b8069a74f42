"""The sheet of an assessment: the structures first, then what the chosen one predicts, then the tests."""

from __future__ import annotations

from bayeshunt.core.units import true_minus
from bayeshunt.models.assessment.assess import Assessment
from bayeshunt.models.assessment.warnings import is_grave
from bayeshunt.models.tables.structures import PREVIOUS
from bayeshunt.views.notebook.html import Html, number, row, table, tag
from bayeshunt.views.sheets.sheet import Drawn, Note, Printed, Sheet
from bayeshunt.views.terminal.assessment import assessment_text

__all__ = ["assessment"]


def assessment(shown: Assessment) -> Sheet:
    """Return an assessment; its text is that of the command."""
    settings = shown.settings
    bins = ", ".join(f"{name} {bins}" for name, bins in settings["bins"].items())
    subtitle = f"{settings['rows']} rows, {settings['folds']} folds, seed {settings['seed']}; bins {bins}"
    accuracy = f"{100 * shown.gaits['accuracy']:.2f} %"
    known = [("gait inferred from Distance and Angle", accuracy), ("prior per cell", number(settings["prior"]))]
    if settings["backoff"] is not None and shown.structures["factors"].str.contains(PREVIOUS).any():
        known.append(("back-off to a gait's own table", f"{number(settings['backoff'])} rows"))
    if shown.given is not None:
        known.append(("the model's own log-loss", number(shown.given["log_loss"], 4)))
    measure = (
        "Held-out log-loss of Distance, Angle and Heading [nat per row]; gain over naive, 95 % interval; "
        "BIC: more is better. Density: the log-loss per m or rad, which compares over bins."
    )
    predictions = f"Predictions of each variable, structure {settings['structure']}"
    drawn = [
        *(Drawn(Note(note)) for note in shown.notes if is_grave(note)),
        Drawn(_structures(shown), Note(measure)),
        Drawn(_factors(shown), title="What each structure assumes"),
        Drawn(_variables(shown), title=predictions),
        Drawn(_independence(shown), title="Independent given the gait?"),
        Drawn(_confusion(shown), title="Gaits taken for others"),
        *(Drawn(Note(note)) for note in shown.notes if not is_grave(note)),
    ]
    return Sheet("Assessment", subtitle, known, [Printed(lambda: assessment_text(shown).splitlines()), *drawn])


def _structures(shown: Assessment) -> Html:
    best = shown.structures["log_loss"].idxmin()
    rows = []
    for name, found in shown.structures.iterrows():
        gain = f"{found['gain']:+.4f} ({found['gain_low']:+.4f} to {found['gain_high']:+.4f})"
        loss = f"{found['log_loss']:.4f}".replace("inf", "∞")
        cells = [
            loss,
            "" if name == "naive" else true_minus(gain),
            true_minus(f"{found['bic']:,.0f}"),
            f"{found['parameters']:,}",
        ]
        rows.append(row(name, cells, lit=name == best))
    return table(["structure", "log-loss", "gain", "BIC", "parameters"], rows)


def _factors(shown: Assessment) -> Html:
    rows = [row(name, [tag("td", factors, class_="bh-left")]) for name, factors in shown.structures["factors"].items()]
    return table(["structure", "P(Distance, Angle, Heading | Gait) ="], rows)


def _variables(shown: Assessment) -> Html:
    columns = ("log_loss", "log_loss_without_gait", "density", "density_without_gait", "brier", "brier_without_gait")
    rows = [row(name, [number(found[c], 4) for c in columns]) for name, found in shown.variables.iterrows()]
    return table(["variable", "log-loss", "without gait", "density", "without gait", "Brier", "without gait"], rows)


def _independence(shown: Assessment) -> Html:
    rows = []
    for _, found in shown.independence.iterrows():
        cells = [number(found["g"], 5), found["degrees"], f"{found['p_permutation']:.3f}", number(found["p_chi2"], 2)]
        cells += [number(found["information_bits"]), number(found["information_chance_bits"])]
        rows.append(row(f"{found['x']}, {found['y']}", cells))
    return table(["pair", "G", "df", "p (shuffles)", "p (chi-square)", "bits", "bits by chance"], rows)


def _confusion(shown: Assessment) -> Html:
    names = list(shown.confusion.columns)
    rows = [
        row(executed, [count or "·" for count in counts])
        for executed, counts in zip(names, shown.confusion.to_numpy().tolist(), strict=True)
    ]
    return table(["executed \\ inferred", *names], rows)
