"""A policy does no I/O and reads no clock: time, samples and frames come in as arguments. Nor does a turn: all that
reaches it and leaves it does so through its `IO`."""

import sys

import pytest

from tests.rules.repository import ROOT, imported_by, name, services
from tests.support.tools import finished

# Of the standard library and the dependencies: what touches the world, the clock or chance.
IMPURE = {
    *{"asyncio", "datetime", "io", "logging", "multiprocessing", "os", "pathlib", "random", "secrets", "select"},
    *{"selectors", "signal", "socket", "subprocess", "sys", "tempfile", "threading", "time", "serial", "zenoh"},
    *{"curses", "termios", "tty"},
}
CORE = ROOT / "services" / "giraff_core"
WIRING = {"main.py", "__main__.py"}
DEVICES = {"giraff_keyboard/terminal.py"}  # what is read and shown where giraff_node has no link for it
DEVICE = "device.py"
"""What a hand is read from."""
PURE = ("hand", "messages")
"""Folders of services in which no module touches the world."""


def impure_imports(source: str) -> list[str]:
    """What a policy must not know, wherever in it that is imported."""
    return [each for each in sorted(imported_by(source)) if each.partition(".")[0] in IMPURE | {"giraff_node"}]


def test_the_core_touches_no_world() -> None:
    found = {name(path): impure_imports(path.read_text()) for path in CORE.rglob("*.py")}
    assert {module: imports for module, imports in found.items() if imports} == {}


@pytest.mark.parametrize("package", services())
def test_only_main_touches_the_world(package: str) -> None:
    folder = ROOT / "services" / package
    modules = [path for path in folder.glob("*.py") if path.name not in WIRING]
    modules += [path for each in PURE for path in (folder / each).rglob("*.py")]
    modules = [path for path in modules if f"{package}/{path.name}" not in DEVICES and path.name != DEVICE]
    found = {path.name: impure_imports(path.read_text()) for path in modules}
    assert {module: imports for module, imports in found.items() if imports} == {}


@pytest.mark.parametrize(
    ("source", "expected"),
    [
        ("import time", ["time"]),
        ("from os.path import exists", ["os.path.exists"]),
        ("def now() -> int:\n    from giraff_node import robot_now_ns", ["giraff_node.robot_now_ns"]),
        ("from giraff_core.robot import RobotConfig", []),
        ("from giraff_core.bounds import require_positive", []),
        ("from giraff_node.config.robot_file import load", ["giraff_node.config.robot_file.load"]),
        ("import math", []),
    ],
)
def test_an_impure_import_shows(source: str, expected: list[str]) -> None:
    assert impure_imports(source) == expected


def parts(package: str) -> list[str]:
    """Modules and folders of a service that touch no world. A door decides nothing."""
    there = {path.stem for path in (ROOT / "services" / package).iterdir()}
    decides = [part for part in ("policy", "hand") if part in there]
    assert decides or package == "giraff_door"
    return ["config", *decides]


LOADS = """
import importlib, sys
for module in {modules}:
    importlib.import_module(module)
print([name for name in sys.modules if name.partition(".")[0] in ("zenoh", "serial", "giraff_node")])
"""


def loaded_of_the_network(modules: list[str]) -> str:
    """What of Zenoh, serial ports and the runtime is loaded once these modules are imported."""
    return finished([sys.executable, "-c", LOADS.format(modules=modules)], check=True).stdout.strip()


def test_importing_a_policy_loads_no_network() -> None:
    modules = [f"{package}.{part}" for package in services() for part in parts(package)]
    modules += ["giraff_ros2.hand.twist_hand"]  # whose folder imports nothing
    assert loaded_of_the_network(modules) == "[]"


def test_an_import_that_loads_the_network_shows() -> None:
    assert "zenoh" in loaded_of_the_network(["giraff_node.network.session"])
