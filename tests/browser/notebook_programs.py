"""JupyterLab and marimo on the loopback interface, with a notebook of given cells; each for one ``with``."""

from __future__ import annotations

import json
import os
import socket
import subprocess
import sys
import textwrap
import time
import urllib.error
import urllib.request
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

__all__ = ["jupyterlab", "marimo"]

TOKEN = "only-for-this-test"


@contextmanager
def jupyterlab(folder: Path, cells: Sequence[str]) -> Iterator[str]:
    """Give the address of a notebook in ``folder``; all its cells are kept in the page, and ``jupyterapp`` is there."""
    (folder / "work").mkdir(exist_ok=True)
    path = folder / "work" / "shown.ipynb"
    path.write_text(json.dumps(_notebook(cells)))
    port = _free_port()
    command = [
        "jupyterlab", "--no-browser", "--allow-root", "--ServerApp.ip=127.0.0.1", f"--ServerApp.port={port}",
        "--ServerApp.port_retries=0", f"--ServerApp.root_dir={path.parent}", f"--IdentityProvider.token={TOKEN}",
        "--LabApp.expose_app_in_browser=True",
    ]  # fmt: skip
    with _serving(folder, command, _jupyter_environment(folder), f"http://127.0.0.1:{port}/api?token={TOKEN}"):
        yield f"http://127.0.0.1:{port}/lab/tree/{path.name}?token={TOKEN}"


@contextmanager
def marimo(folder: Path, cells: Sequence[str], theme: str) -> Iterator[str]:
    """Give the address of an app of ``cells``; theme: "light", "dark" or "system"."""
    (folder / "work").mkdir(exist_ok=True)
    path = folder / "work" / "shown.py"
    made = "".join(f"\n@app.cell\ndef _():\n{textwrap.indent(cell, '    ')}\n    return\n\n" for cell in cells)
    path.write_text(f'import marimo\n\napp = marimo.App(width="medium")\n\n{made}')
    config = folder / "config" / "marimo" / "marimo.toml"
    config.parent.mkdir(parents=True)
    config.write_text(f'[display]\ntheme = "{theme}"\n')
    port = _free_port()
    command = [
        "marimo", "--log-level", "warn", "run", path.name, "--headless", "--no-token", "--host", "127.0.0.1",
        "--port", str(port),
    ]  # fmt: skip
    home = {name: str(folder / name.lower()) for name in ("HOME", "XDG_STATE_HOME", "XDG_CACHE_HOME")}
    environment = {**os.environ, **home, "XDG_CONFIG_HOME": str(folder / "config")}
    with _serving(folder, command, environment, f"http://127.0.0.1:{port}/health"):
        yield f"http://127.0.0.1:{port}/"


@contextmanager
def _serving(folder: Path, command: list[str], environment: dict[str, str], address: str) -> Iterator[None]:
    """Run ``python -m command`` until the end of the ``with``."""
    log = folder / "log.txt"
    with log.open("w") as said:
        whole = [sys.executable, "-m", *command]
        server = subprocess.Popen(whole, env=environment, cwd=folder / "work", stdout=said, stderr=said)
        try:
            _wait_for(address, server, log)
            yield
        finally:
            server.terminate()
            try:
                server.wait(20)
            except subprocess.TimeoutExpired:
                server.kill()


def _notebook(cells: Sequence[str]) -> dict[str, object]:
    made = [
        {"cell_type": "code", "id": f"cell-{i}", "source": code, "metadata": {}, "outputs": [], "execution_count": None}
        for i, code in enumerate(cells)
    ]
    kernel = {"kernelspec": {"name": "python3", "display_name": "Python 3", "language": "python"}}
    return {"cells": made, "metadata": kernel, "nbformat": 4, "nbformat_minor": 5}


def _jupyter_environment(folder: Path) -> dict[str, str]:
    """An environment in which Jupyter reads and writes nothing outside ``folder``."""
    command = [sys.executable, "-m", "ipykernel_launcher", "-f", "{connection_file}"]
    files = {
        "data/kernels/python3/kernel.json": {"argv": command, "display_name": "Python 3", "language": "python"},
        "config/labconfig/page_config.json": {
            "disabledExtensions": {"@jupyterlab/apputils-extension:announcements": True}
        },
        "settings/@jupyterlab/notebook-extension/tracker.jupyterlab-settings": {"windowingMode": "none"},
    }
    for name, content in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(json.dumps(content))
    places = {
        "JUPYTER_CONFIG_DIR": "config", "JUPYTER_DATA_DIR": "data", "JUPYTER_RUNTIME_DIR": "runtime",
        "JUPYTERLAB_SETTINGS_DIR": "settings", "JUPYTERLAB_WORKSPACES_DIR": "workspaces", "IPYTHONDIR": "ipython",
    }  # fmt: skip
    return {**os.environ, **{name: str(folder / place) for name, place in places.items()}}


def _free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def _wait_for(address: str, server: subprocess.Popen[bytes], log: Path) -> None:
    end = time.monotonic() + 90
    while time.monotonic() < end:
        assert server.poll() is None, f"it stopped:\n{log.read_text()[-2000:]}"
        try:
            urllib.request.urlopen(address, timeout=5).close()
            return
        except (urllib.error.URLError, OSError):
            time.sleep(0.3)
    raise AssertionError(f"it did not answer:\n{log.read_text()[-2000:]}")
