"""Who may import whom. The contracts are in pyproject.toml; these tests run them and try to break them."""

from __future__ import annotations

import json
import os
import shutil
import sys
from pathlib import Path
from typing import Any

import pytest

from tests.rules.repository import ROOT, SOURCE_ROOTS, packages, pyproject, services
from tests.support.tools import finished

LINT_IMPORTS = Path(sys.executable).with_name("lint-imports")


def lint_imports(tree: Path) -> tuple[int, str]:
    """Exit code and report of the contracts, over the packages of `tree`."""
    search = os.pathsep.join(str(tree / root) for root in SOURCE_ROOTS)
    command: list[str | Path] = [LINT_IMPORTS, "--no-cache", "--config", ROOT / "pyproject.toml"]
    run = finished(command, cwd=tree, env=os.environ | {"PYTHONPATH": search})
    return run.returncode, run.stdout + run.stderr


def contract(kind: str) -> dict[str, Any]:
    """The first contract of that type."""
    return next(each for each in pyproject()["tool"]["importlinter"]["contracts"] if each["type"] == kind)


@pytest.fixture
def tree(tmp_path: Path) -> Path:
    """A copy of the sources that a test may spoil."""
    for root in SOURCE_ROOTS:
        shutil.copytree(ROOT / root, tmp_path / root, ignore=shutil.ignore_patterns("__pycache__"))
    return tmp_path


def plant(tree: Path, module: str, line: str) -> None:
    with (tree / module).open("a") as source:
        source.write(f"\n{line}\n")


def test_contracts_hold() -> None:
    code, report = lint_imports(ROOT)
    assert code == 0, report


@pytest.mark.parametrize(
    ("module", "line"),
    [
        ("services/giraff_base/policy.py", "import giraff_guard.policy"),
        ("services/giraff_guard/main.py", "from giraff_ranger import config"),
        ("services/giraff_odometry/main.py", "import giraff_sim"),
        ("services/giraff_node/__init__.py", "import giraff_base.policy"),
        ("schemas/giraff_schemas/__init__.py", "import giraff_node"),
        ("services/giraff_sim/main.py", "import giraff_base.main"),
        ("services/giraff_sim/main.py", "import giraff_base.policy"),
        ("services/giraff_cli/main.py", "import giraff_base.service"),
        ("services/giraff_cli/main.py", "import giraff_joystick.main"),
        ("services/giraff_cli/run/plan.py", "import giraff_web.service"),
        ("services/giraff_cli/run/plan.py", "import giraff_localization.service"),
        ("services/giraff_client/robot.py", "import giraff_cli.network.connection"),
        ("services/giraff_cli/main.py", "import giraff_client"),
        ("services/giraff_core/robot.py", "import giraff_node.node"),
        ("services/giraff_cli/why/explain.py", "import giraff_cli.watch.monitor"),
        ("services/giraff_cli/network/ports.py", "import giraff_cli.telemetry.rate"),
        ("services/giraff_cli/terminal/text.py", "import giraff_cli.network.ports"),
        ("services/giraff_sim/hosts/disk.py", "import giraff_sim.hosts.process"),
    ],
)
def test_a_planted_import_breaks_a_contract(tree: Path, module: str, line: str) -> None:
    plant(tree, module, line)
    code, report = lint_imports(tree)
    assert code == 1
    assert "BROKEN" in report


def test_the_simulation_may_import_a_turn_the_command_line_a_policy_and_both_its_configuration(tree: Path) -> None:
    plant(tree, "services/giraff_sim/main.py", "import giraff_base.service, giraff_guard.config")
    plant(tree, "services/giraff_cli/main.py", "import giraff_guard.policy, giraff_base.config")
    code, report = lint_imports(tree)
    assert code == 0, report


def test_contracts_name_every_package() -> None:
    linter = pyproject()["tool"]["importlinter"]
    assert sorted(linter["root_packages"]) == packages()
    layers, forbidden = (contract(kind) for kind in ("layers", "forbidden"))
    assert sorted(layers["layers"][2].split(" | ")) == services()
    assert sorted(forbidden["forbidden_modules"]) == services()
    assert sorted(contract("acyclic_siblings")["ancestors"]) == packages()


@pytest.mark.parametrize("package", services())
def test_a_service_is_configuration_policy_and_main(package: str) -> None:
    modules = {path.name for path in (ROOT / "services" / package).iterdir()}
    assert {"__init__.py", "__main__.py", "config.py", "policy.py", "main.py"} <= modules


LIST_NEW_IMPORTS = """
import json, sys
before = set(sys.modules)
{statement}
site = [path for path in sys.path if path.endswith("-packages")]
print(json.dumps(sorted(
    {{name.partition(".")[0] for name, module in sys.modules.items() if name not in before
      and any((getattr(module, "__file__", None) or "").startswith(path) for path in site)}}
)))
"""


def installed_packages_imported_by(statement: str) -> set[str]:
    """Top-level names of the installed distributions, not the standard library, that a statement loads."""
    script = LIST_NEW_IMPORTS.format(statement=statement)
    run = finished([sys.executable, "-c", script], check=True)
    return set(json.loads(run.stdout))


# What requirements/robot.lock installs, and what msgspec takes along where it happens to be. The robot's
# 32-bit computer has neither numpy nor rerun.
ROBOT_SIDE = {"zenoh", "msgspec", "serial", "typing_extensions"}
OF_ONE_SERVICE = {
    "giraff_recorder": {"mcap", "lz4", "zstandard", "_cffi_backend"},
    "giraff_web": {
        *("aiohttp", "aiohappyeyeballs", "aiosignal", "attr", "frozenlist", "multidict", "propcache", "yarl", "idna"),
        *("cryptography", "_cffi_backend"),
    },
    "giraff_localization": {"numpy"},
}
"""What only requirements/recorder.lock, web.lock and localization.lock install."""


@pytest.mark.parametrize("package", ["giraff_schemas", "giraff_core", "giraff_node", "giraff_client", *services()])
def test_the_robots_side_needs_the_robots_lock_only(package: str) -> None:
    statement = f"""
import importlib, pkgutil, {package}
for module in pkgutil.walk_packages({package}.__path__, "{package}."):
    if not module.name.endswith("__main__"):
        importlib.import_module(module.name)
"""
    assert installed_packages_imported_by(statement) <= ROBOT_SIDE | OF_ONE_SERVICE.get(package, set())


def test_an_import_that_does_not_belong_on_the_robot_shows() -> None:
    assert "numpy" in installed_packages_imported_by("import numpy")
    assert "typer" in installed_packages_imported_by("import zenoh, typer")
