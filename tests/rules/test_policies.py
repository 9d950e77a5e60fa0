"""A policy does no I/O and reads no clock: time, samples and frames come in as arguments. Nor does a turn: all that
reaches it and leaves it does so through its `IO`."""

from __future__ import annotations

import ast

import pytest

from tests.rules.repository import ROOT, services

# Of the standard library and the dependencies: what touches the world, the clock or chance.
IMPURE = {
    *{"asyncio", "datetime", "io", "logging", "multiprocessing", "os", "pathlib", "random", "secrets", "select"},
    *{"selectors", "signal", "socket", "subprocess", "sys", "tempfile", "threading", "time", "serial", "zenoh"},
    *{"curses", "termios", "tty"},
}
PURE_RUNTIME = {
    *{"giraff_node.base_frames", "giraff_node.counters", "giraff_node.estop", "giraff_node.freshness"},
    *{"giraff_node.lease", "giraff_node.live", "giraff_node.robot", "giraff_node.tick_down"},
    *{"giraff_node.access", "giraff_node.ranges", "giraff_node.site"},
    *{"giraff_node.inbox", "giraff_node.io", "giraff_node.pacing", "giraff_node.repeating"},
}
WIRING = {"main.py", "__main__.py"}
DEVICES = {"giraff_keyboard/terminal.py"}  # what is read and shown where giraff_node has no link for it


def impure_imports(source: str) -> list[str]:
    """Modules that a policy must not know, wherever in it they are imported."""
    imported = []
    for node in ast.walk(ast.parse(source)):
        match node:
            case ast.Import(names=names):
                imported += [alias.name for alias in names]
            case ast.ImportFrom(module=str(module)):
                imported.append(module)
    return [
        module
        for module in imported
        if module.partition(".")[0] in IMPURE
        or (module.partition(".")[0] == "giraff_node" and module not in PURE_RUNTIME)
    ]


@pytest.mark.parametrize("package", services())
def test_only_main_touches_the_world(package: str) -> None:
    modules = [path for path in (ROOT / "services" / package).glob("*.py") if path.name not in WIRING]
    modules = [path for path in modules if f"{package}/{path.name}" not in DEVICES]
    found = {path.name: impure_imports(path.read_text()) for path in modules}
    assert {module: imports for module, imports in found.items() if imports} == {}


@pytest.mark.parametrize(
    ("source", "expected"),
    [
        ("import time", ["time"]),
        ("from os.path import exists", ["os.path"]),
        ("def now() -> int:\n    from giraff_node import robot_now_ns", ["giraff_node"]),
        ("from giraff_node.robot import RobotConfig", []),
        ("from giraff_node.ranges import require_positive", []),
        ("from giraff_node.config import load", ["giraff_node.config"]),
        ("import math", []),
    ],
)
def test_an_impure_import_shows(source: str, expected: list[str]) -> None:
    assert impure_imports(source) == expected
