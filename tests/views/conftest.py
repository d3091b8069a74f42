"""One of everything that shows itself, made once."""

from __future__ import annotations

from types import SimpleNamespace

import pytest
from html_checks import NASTY

import bayeshunt as bh


@pytest.fixture(scope="session")
def shown(khepera_frame, khepera_model, tmp_path_factory) -> SimpleNamespace:
    """Models, answers, tables, plans and hunts of the Khepera."""
    model, gaits = khepera_model, khepera_model.gaits
    smooth = bh.ForwardModel.fit(khepera_frame, gaits, prior=0.5)
    planned = bh.hunt("paper", bh.make_planner("planning", model), arena="open", theta=1.0, seed=0)
    long = bh.hunt("paper", bh.make_planner("reactive", model), arena="walled", theta=4.0, seed=3)
    path = tmp_path_factory.mktemp("shown") / "hunt.parquet"
    planned.save(path)
    model.to_xmlbif(path.with_suffix(".xmlbif"))
    imported = bh.import_network(path.with_suffix(".xmlbif"))
    aimed = bh.hunt("paper", bh.make_planner("reactive", imported), arena="walled", theta=4.0, seed=3)
    return SimpleNamespace(
        model=model,
        tree=bh.ForwardModel.fit(khepera_frame, gaits, prior=0.5, structure="tan"),
        joint=bh.ForwardModel.fit(khepera_frame, gaits, structure="joint"),
        empty=bh.ForwardModel.empty(gaits),
        imported=imported,
        imported_inverse=bh.InverseModel(imported),
        imported_answer=bh.InverseModel(imported).posterior(0.3, 3.0, 0.7),
        imported_table=imported.table("Angle"),
        imported_aim=aimed.plans[2],
        imported_hunt=aimed,
        inverse=bh.InverseModel(model),
        answer=bh.InverseModel(smooth).posterior(0.151, 0.55),
        snapped=bh.InverseModel(model).posterior(0.3, 3.0, 0.7),
        table=smooth.table("Angle"),
        gait_table=smooth.table("Gait"),
        prey=long.situations[-1].prey_model,
        no_prey=bh.PreyModel(),
        plan=planned.plans[2],
        aim=long.plans[2],
        episode=planned,
        long=long,
        loaded=bh.Episode.load(path),
    )


#: What of it shows itself.
NAMES = (
    "model", "tree", "joint", "empty", "imported", "inverse", "answer", "snapped", "table", "gait_table", "prey",
    "imported_inverse", "imported_answer", "imported_table", "imported_aim", "imported_hunt",
    "no_prey", "plan", "aim", "episode", "long", "loaded",
)  # fmt: skip


@pytest.fixture(params=NAMES)
def thing(request, shown):
    """Each of them in turn."""
    return getattr(shown, request.param)


@pytest.fixture(scope="session")
def nasty(khepera_frame) -> SimpleNamespace:
    """The same robot, its gaits called by ``NASTY``."""
    settings = bh.load_experiment("paper")
    record = settings.model_dump()
    for gait, name in zip(record["robot"]["gait"], NASTY, strict=True):
        gait["name"] = name
    settings = type(settings).model_validate(record)
    names = dict(zip((g.name for g in bh.load_robot("khepera").gaits), NASTY, strict=True))
    frame = khepera_frame.assign(gait=khepera_frame["gait"].map(names))
    model = bh.ForwardModel.fit(frame, settings.robot.gaits, prior=0.1)
    planned = bh.hunt(settings, bh.make_planner("planning", model), arena="open", theta=1.0, seed=0)
    aimed = bh.hunt(settings, bh.make_planner("reactive", model), arena="walled", theta=4.0, seed=3)
    things = [
        model, bh.InverseModel(model), bh.InverseModel(model).posterior(0.1, 0.3), model.table("Distance"),
        planned, aimed, planned.plans[1], aimed.plans[1],
    ]  # fmt: skip
    return SimpleNamespace(settings=settings, model=model, planned=planned, aimed=aimed, things=things)
