"""A service's turn is written once: its process and the simulation run the same class of its `service.py`."""

import ast
import re
from pathlib import Path

import pytest

from tests.rules.repository import ROOT, services

# What is not in the chain that drives, and no simulation runs, may turn in its main.
LOOPS_OF_THEIR_OWN = {"giraff_door", "giraff_recorder", "giraff_router", "giraff_sentry"}
GIVEN_TO_A_NODE = sorted({*services()} - LOOPS_OF_THEIR_OWN)


def calls(source: str, method: str) -> int:
    """How often a method of that name is called."""
    return method in source and sum(
        isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr == method
        for node in ast.walk(ast.parse(source))
    )


@pytest.mark.parametrize("package", GIVEN_TO_A_NODE)
def test_a_process_gives_the_turn_to_the_node(package: str) -> None:
    modules = {path.name: path.read_text() for path in (ROOT / "services" / package).rglob("*.py")}
    assert modules.keys() & {"service.py", "hand.py"}
    assert calls(modules.get("main.py", ""), "run") == ("main.py" in modules)
    assert [name for name, source in modules.items() if calls(source, "turns")] == []


def test_only_the_node_turns_them() -> None:
    def loops(package: str) -> list[Path]:
        return [path for path in (ROOT / "services" / package).rglob("*.py") if calls(path.read_text(), "turns")]

    packages = {path.name for path in (ROOT / "services").iterdir() if loops(path.name)}
    assert packages == LOOPS_OF_THEIR_OWN | {"giraff_node"}


def test_the_simulation_knows_no_policy() -> None:
    """What it knows of a service is its turn: with a policy in its hands it could write a second one."""
    found = {
        path.name: node.module
        for path in (ROOT / "services" / "giraff_sim").rglob("*.py")
        if re.search(r"\.(policy|main)\b", source := path.read_text())
        for node in ast.walk(ast.parse(source))
        if isinstance(node, ast.ImportFrom) and str(node.module).endswith((".policy", ".main"))
    }
    assert {name: module for name, module in found.items() if not str(module).startswith("giraff_sim")} == {}
