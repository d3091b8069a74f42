"""A headless Chromium for the pages and the widget; without one these tests are skipped, with the reason."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tarfile
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import pytest

import bayeshunt as bh
from bayeshunt.views.pages.replay import write_replay

sys.path.insert(0, str(Path(__file__).parent.parent / "models"))  # network_questions
playwright_api = pytest.importorskip("playwright.sync_api", reason="playwright is not installed (extra: test)")
CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")


@dataclass
class Watch:
    """What a page complained about and what it asked of the network."""

    errors: list[str] = field(default_factory=list)
    requests: list[str] = field(default_factory=list)


@pytest.fixture(scope="session")
def browser() -> Iterator[object]:
    if CHROMIUM is None:
        pytest.skip("no chromium on this machine")
    with playwright_api.sync_playwright() as playwright:
        # Root, as in a container, has no sandbox.
        running = playwright.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        yield running
        running.close()


@pytest.fixture
def open_page(browser):
    """Return a function that opens an address and gives the page and its watch."""
    contexts = []

    def opened(address: str | Path, **settings):
        context = browser.new_context(**{"viewport": {"width": 1280, "height": 900}, **settings})
        context.set_default_navigation_timeout(120_000)  # marimo loads hundreds of files
        contexts.append(context)
        page, watch = context.new_page(), Watch()
        page.on("console", lambda m: watch.errors.append(m.text) if m.type in ("error", "warning") else None)
        page.on("pageerror", lambda error: watch.errors.append(str(error)))
        page.on("request", lambda request: watch.requests.append(request.url))
        url = address if isinstance(address, str) else address.as_uri()
        page.goto(url)
        return page, watch

    yield opened
    for context in contexts:
        context.close()


@pytest.fixture(scope="session")
def settings():
    return bh.load_experiment("paper", {"model.babbling_steps": 600, "protocol.runs": 2})


@pytest.fixture(scope="session")
def model(settings):
    from bayeshunt.experiments.protocol import learn_model

    return learn_model(settings, 0)


@pytest.fixture(scope="session")
def episodes(settings, model):
    """One hunt of every planner of the paper, by name."""
    hunts = {"reactive": ("open", 1.0, 0), "prediction": ("walled", 2.0, 3), "planning": ("open", 4.0, 0)}
    made = {
        name: bh.hunt(settings, bh.make_planner(name, model), arena=arena, theta=theta, seed=seed)
        for name, (arena, theta, seed) in hunts.items()
    }
    assert all(len(episode.frame) >= 5 for episode in made.values())  # long enough to walk about in
    return made


@pytest.fixture(scope="session")
def replays(episodes, model, tmp_path_factory) -> dict[str, Path]:
    """The page of each episode."""
    folder = tmp_path_factory.mktemp("replays")
    for name, episode in episodes.items():
        write_replay(episode, folder / f"{name}.html", model=model)
    return {name: folder / f"{name}.html" for name in episodes}


@pytest.fixture(scope="session")
def axe(tmp_path_factory) -> str:
    """The script of axe-core: the file that AXE_CORE names, or the one in npm's registry."""
    if given := os.environ.get("AXE_CORE"):
        return Path(given).read_text(encoding="utf-8")
    if shutil.which("npm") is None:
        pytest.skip("npm is not installed, and AXE_CORE names no axe.min.js")
    folder = tmp_path_factory.mktemp("axe")
    got = subprocess.run(
        ["npm", "pack", "--silent", "axe-core"], cwd=folder, capture_output=True, text=True, timeout=120
    )
    packs = list(folder.glob("*.tgz"))
    if got.returncode or not packs:
        pytest.skip("axe-core cannot be had from npm here")
    with tarfile.open(packs[0]) as pack:
        return pack.extractfile("package/axe.min.js").read().decode()
