"""Make the pictures of the README: ``python docs/make_images.py``.

Needs the extras ``notebook`` and ``test`` and a Chromium on the path. Everything is made from presets
and seed 0, so the pictures change only when the program does.
"""

from __future__ import annotations

import json
import shutil
import sys
import tempfile
from pathlib import Path

import gymnasium
from matplotlib.image import imsave
from playwright.sync_api import Browser, sync_playwright

import bayeshunt as bh
from bayeshunt.experiments.preparation import learn_rooms, prepare_planner
from bayeshunt.experiments.protocol import learn_model
from bayeshunt.views.figures.hunts import hunts
from bayeshunt.views.figures.style import save
from bayeshunt.views.pages.page import embed

IMAGES = Path(__file__).parent / "images"
#: Planners of the figure of hunts, and the hunt that all of them get.
PLANNERS, THETA, SEED = ("reactive", "prediction", "planning", "intercept_walls"), 4.0, 8
LIMIT = 200_000  # bytes of one picture

_STAND_IN = """
const values = JSON.parse(document.getElementById("values").textContent);
const source = new Blob([document.getElementById("widget").textContent], { type: "text/javascript" });
import(URL.createObjectURL(source)).then((module) => {
  const model = { get: (name) => values[name], set() {}, save_changes() {}, on() {}, off() {} };
  module.default.render({ model, el: document.getElementById("place") });
  document.body.dataset.ready = "yes";
});
"""


def main() -> None:
    """Make every picture and check its size."""
    IMAGES.mkdir(exist_ok=True)
    settings = bh.load_experiment("paper")
    model = learn_model(settings, 0)
    rooms = learn_rooms(settings, PLANNERS, settings.arenas, 0, model)
    episodes = [
        bh.hunt(settings, prepare_planner(name, model, settings, rooms, arena), arena=arena, theta=THETA, seed=SEED)
        for arena in ("walled", "open")
        for name in PLANNERS
    ]
    with tempfile.TemporaryDirectory() as folder:
        png, _ = save(hunts(episodes), folder, "hunts")
        shutil.copy(png, IMAGES / "hunts.png")
        draw_environment()
        chromium = shutil.which("chromium") or sys.exit("no chromium on the path: apt install chromium")
        with sync_playwright() as playwright:
            browser = playwright.chromium.launch(executable_path=chromium, args=["--no-sandbox"])
            draw_replay(browser, episodes[6], model, Path(folder))
            slippery = bh.load_experiment("slippery")
            graded = learn_model(slippery, 0)
            unsure = bh.hunt(slippery, bh.make_planner("prediction", graded), arena="walled", theta=1.0, seed=1)
            draw_posterior(browser, unsure, graded, Path(folder))
            draw_explorer(browser, graded, Path(folder))
            draw_network(browser, graded, Path(folder))
            browser.close()
    for name in ("hunts", "replay", "posterior", "explorer", "network"):
        size = (IMAGES / f"{name}.png").stat().st_size
        print(f"{IMAGES / name}.png: {size} bytes")
        if size > LIMIT:
            sys.exit(f"{name}.png is larger than {LIMIT} bytes")


def draw_environment() -> None:
    """A frame of Hunt-v0, in its third time-step."""
    env = gymnasium.make("bayeshunt.envs:Hunt-v0", preset="paper", arena="walled", render_mode="rgb_array")
    env.reset(options={"theta": 1.0, "hunt_seed": 7})
    for gait in (0, 2, 1):
        env.step(gait)
    imsave(IMAGES / "hunt_env.png", env.render())
    env.close()


def draw_replay(browser: Browser, episode: bh.Episode, model: bh.ForwardModel, folder: Path) -> None:
    """The replay of a planning hunt, some decisions in."""
    bh.write_replay(episode, folder / "replay.html", model=model)
    page = browser.new_page(viewport={"width": 1240, "height": 830})
    page.goto((folder / "replay.html").as_uri())
    for _ in range(4):
        page.keyboard.press("ArrowRight")
    page.locator("[data-part=icicle] rect.lit").last.hover()
    page.screenshot(path=IMAGES / "replay.png")
    page.close()


def draw_posterior(browser: Browser, episode: bh.Episode, model: bh.ForwardModel, folder: Path) -> None:
    """What the replay shows of the decision whose answer is the least certain."""
    bh.write_replay(episode, folder / "posterior.html", model=model)
    page = browser.new_page(viewport={"width": 1240, "height": 830})
    page.goto((folder / "posterior.html").as_uri() + f"#d={1 + int(episode.frame['posterior'].map(max).argmin())}")
    page.locator(".panels .left").screenshot(path=IMAGES / "posterior.png")
    page.close()


def draw_explorer(browser: Browser, model: bh.ForwardModel, folder: Path) -> None:
    """The explorer's own script and style in a bare page, with the values that Python sends."""
    explorer = bh.Explorer(model, distance=0.14, angle=0.5)
    values = {name: getattr(explorer, name) for name in ("distance", "angle", "_scene", "_answer")}
    page = browser.new_page(viewport={"width": 860, "height": 520})
    (folder / "explorer.html").write_text(
        f"<!doctype html><meta charset='utf-8'><style>{bh.Explorer._css}</style><div id='place'></div>"
        f"<script type='application/json' id='values'>{embed(json.loads(json.dumps(values)))}</script>"
        f"<script type='text/plain' id='widget'>{bh.Explorer._esm}</script>"
        f"<script>{_STAND_IN}</script>",
        encoding="utf-8",
    )
    page.goto((folder / "explorer.html").as_uri())
    page.wait_for_selector("body[data-ready]")
    page.locator(".bh-explorer").screenshot(path=IMAGES / "explorer.png")
    page.close()


def draw_network(browser: Browser, model: bh.ForwardModel, folder: Path) -> None:
    """The network with two nodes known."""
    network = bh.Network(model)
    network.save(folder / "network.html")
    page = browser.new_page(viewport={"width": 1180, "height": 660})
    page.goto((folder / "network.html").as_uri())
    for node, value in (("Distance", 0.14), ("Angle", 0.5)):
        state = network.states[node].index(network.named({node: value})["evidence"][node])
        page.get_by_role("listbox", name=node).get_by_role("option").nth(state).click()
    page.mouse.move(5, 5)
    page.locator("#place").screenshot(path=IMAGES / "network.png")
    page.close()


if __name__ == "__main__":
    main()
