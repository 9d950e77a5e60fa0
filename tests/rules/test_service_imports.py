"""A service of the robot imports what it runs on and no more: each module takes time at a start, and memory."""

import sys
from typing import Final

import pytest

from tests.support.tools import finished

_MOST: Final = {"base": 123, "guard": 121, "ranger": 99, "odometry": 95}
"""Modules of ours."""
_MOST_OF_OTHERS: Final = 102
"""Modules of Python and of libraries. Another version of Python may have a few more."""
_NOT_NEEDED: Final = {
    *("argparse", "asyncio", "concurrent", "dataclasses", "difflib", "email", "hashlib", "http", "inspect", "json"),
    *("importlib.metadata", "multiprocessing", "random", "secrets", "shlex", "shutil", "ssl", "subprocess", "tempfile"),
    *("unittest", "urllib.request", "xml", "zipfile"),
    *("giraff_cli", "giraff_sim", "giraff_telemetry", "giraff_core.operator", "giraff_node.network.discovery"),
    "giraff_node.network.bulk_session",
}
_WITHOUT_BOARD: Final = {"guard", "odometry"}

# A child for each service, so that none is charged with what another imports. The robot has no typing_extensions.
_SCRIPT: Final = """
import os, sys
from importlib import import_module
sys.modules["typing_extensions"] = None
before = set(sys.modules)
for service in sys.argv[1:]:
    if not os.fork():
        for module in service.split(","):
            import_module(module)
        print(*sorted(set(sys.modules) - before), flush=True)
        os._exit(0)
    os.wait()
"""


def imports_of(service: str) -> str:
    """Return the modules that its process imports before its first turn."""
    board = () if service in _WITHOUT_BOARD else ("giraff_node.boards.board_link",)
    return ",".join(("giraff_node.start", f"giraff_{service}.config", f"giraff_{service}.service", *board))


@pytest.fixture(scope="module")
def imported() -> dict[str, list[str]]:
    lines = finished([sys.executable, "-I", "-c", _SCRIPT, *map(imports_of, _MOST)], check=True).stdout.splitlines()
    return {service: line.split() for service, line in zip(_MOST, lines, strict=True)}


@pytest.mark.parametrize("service", _MOST)
def test_a_service_imports_what_it_runs_on(imported: dict[str, list[str]], service: str) -> None:
    modules = imported[service]
    strange = [each for each in modules if any(f"{each}.".startswith(f"{name}.") for name in _NOT_NEEDED)]
    assert strange == [], f"{service} does not run on these: import them in the function that needs them"
    if service in _WITHOUT_BOARD:
        assert "serial" not in modules, f"{service} has no board: import what reads one in the function that needs it"
    ours = [each for each in modules if each.startswith("giraff_")]
    why = f"`python -X importtime -m giraff_node {service}` shows who imports them"
    assert len(ours) <= _MOST[service], f"{why}; import what is seldom used where it is used, or raise the limit"
    others = len(modules) - len(ours)
    assert others <= _MOST_OF_OTHERS, f"{why}; import what is seldom used where it is used, or raise the limit"
