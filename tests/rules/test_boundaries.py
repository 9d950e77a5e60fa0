"""Who may import whom. The contracts are in imports.toml; these tests run them and try to break them."""

import json
import os
import re
import shutil
import sys
import tomllib
from pathlib import Path
from tempfile import NamedTemporaryFile

import pytest

from giraff_schemas.services import SERVICES, Service
from tests.rules.repository import ROOT, SOURCE_ROOTS, contracts, packages, services
from tests.rules.test_policies import parts
from tests.support.tools import finished

LINT_IMPORTS = Path(sys.executable).with_name("lint-imports")


def lint_imports(tree: Path) -> tuple[int, str]:
    """Exit code and report of the contracts, over the packages of `tree`."""
    search = os.pathsep.join(str(tree / root) for root in SOURCE_ROOTS)
    with NamedTemporaryFile("w", suffix=".toml", encoding="utf-8") as config:
        config.write(contracts())
        config.flush()
        command: list[str | Path] = [LINT_IMPORTS, "--no-cache", "--config", config.name]
        run = finished(command, cwd=tree, env=os.environ | {"PYTHONPATH": search})
    return run.returncode, run.stdout + run.stderr


@pytest.fixture
def tree(tmp_path: Path) -> Path:
    """Links to the sources: `plant` puts a copy in the place of one."""
    for root in SOURCE_ROOTS:
        without = shutil.ignore_patterns("__pycache__")
        shutil.copytree(ROOT / root, tmp_path / root, ignore=without, copy_function=os.symlink)
    return tmp_path


def plant(tree: Path, importer: str, *imported: str) -> None:
    """Append imports to a copy of a module."""
    root = "schemas" if importer.startswith("giraff_schemas") else "services"
    path = tree / root / importer.replace(".", "/")
    source = path / "__init__.py" if path.is_dir() else path.with_suffix(".py")
    text = source.read_text()
    source.unlink()
    source.write_text(text + "".join(f"\nimport {module}\n" for module in imported))


PLANTED = [
    ("giraff_base.policy", "giraff_guard.policy"),
    ("giraff_guard.service", "giraff_ranger.config"),
    ("giraff_odometry.service", "giraff_sim"),
    ("giraff_node", "giraff_base.policy"),
    ("giraff_schemas", "giraff_node"),
    ("giraff_sim.main", "giraff_router.main"),
    ("giraff_sim.main", "giraff_base.policy"),
    ("giraff_cli.main", "giraff_base.service"),
    ("giraff_cli.main", "giraff_gateway.service"),
    ("giraff_cli.run.plan", "giraff_web.service"),
    ("giraff_cli.run.plan", "giraff_localization.service"),
    ("giraff_cli.run.plan", "giraff_ros2.main"),
    ("giraff_client.robot", "giraff_cli.main"),
    ("giraff_cli.main", "giraff_client"),
    ("giraff_core.robot", "giraff_node.node"),
    ("giraff_cli.why.explain", "giraff_cli.watch.monitor"),
    ("giraff_telemetry.rate", "giraff_tools.network.ports"),
    ("giraff_tools.terminal.text", "giraff_tools.network.ports"),
]
CIRCLE = ("giraff_sim.hosts.disk", "giraff_sim.hosts.process")


def test_each_planted_import_breaks_a_contract(tree: Path) -> None:
    """The report lists each as an import that is not allowed by itself, not as part of a longer chain."""
    for importer, imported in (*PLANTED, CIRCLE):
        plant(tree, importer, imported)
    code, report = lint_imports(tree)
    assert code == 1
    broken = re.findall(r"^- +(\S+) -> (\S+) \(l\.\d+\)\n\n", report, re.MULTILINE)
    assert set(PLANTED) - set(broken) == set(), report
    [circle] = re.findall(r"^No cycles are allowed in giraff_sim\.hosts\.\n[^-]*\n- (.*)$", report, re.MULTILINE)
    assert circle == ".disk -> .process (1 import)"


def test_contracts_hold_and_the_simulation_may_import_a_turn_the_command_line_a_policy_and_both_its_configuration(
    tree: Path,
) -> None:
    plant(tree, "giraff_sim.main", "giraff_base.service", "giraff_guard.config")
    plant(tree, "giraff_cli.main", "giraff_guard.policy", "giraff_base.config")
    code, report = lint_imports(tree)
    assert code == 0, report


def test_each_package_has_its_layer() -> None:
    first = tomllib.loads(contracts())["tool"]["importlinter"]["contracts"][0]
    assert sorted(name for layer in first["layers"] for name in layer.split(" | ")) == packages()


@pytest.mark.parametrize("service", [service for service in SERVICES if service.entry], ids=lambda each: each.name)
def test_a_service_is_configuration_policy_and_entry(service: Service) -> None:
    modules = {path.stem for path in (ROOT / "services" / service.package).iterdir()}
    assert {"__init__", *parts(service.package), service.entry} <= modules


LOAD = """
import importlib, json, os, pkgutil, sys

site = tuple(path for path in sys.path if path.endswith("-packages"))

def load(package):
    for module in pkgutil.walk_packages(importlib.import_module(package).__path__, f"{package}."):
        if not module.name.endswith("__main__"):
            importlib.import_module(module.name)
    loaded = {name.partition(".")[0] for name, module in sys.modules.items() if name not in known
              and (getattr(module, "__file__", None) or "").startswith(site)}
    print(json.dumps([package, sorted(loaded)]), flush=True)

known = set(sys.modules)
shared, alone = (words.split() for words in sys.argv[1:])
for package in shared:
    load(package)
for package in alone:
    if os.fork() == 0:
        load(package)
        os._exit(0)
    assert os.wait()[1] == 0, package
"""
"""Prints what each package loads. Those of the second argument know nothing of each other: each has its own process."""

# What requirements/robot.lock installs, and what msgspec takes along where it happens to be. The robot's
# 32-bit computer has neither numpy nor rerun.
ROBOT_SIDE = {"zenoh", "msgspec", "serial", "typing_extensions"}
OF_ONE_SERVICE = {
    "giraff_recorder": {"mcap", "lz4", "zstandard", "_cffi_backend"},
    "giraff_web": {
        *("aiohttp", "aiohappyeyeballs", "aiosignal", "attr", "frozenlist", "multidict", "propcache", "yarl", "idna"),
        *("cryptography", "_cffi_backend"),
        "backports",  # where rosbags has brought them, aiohttp takes them
    },
    "giraff_localization": {"numpy"},
    "giraff_places": {"numpy"},
    "giraff_camera": {"numpy", "cv2"},
    "giraff_vision": {"numpy", "cv2"},
    "giraff_ros2": {"numpy", "rosbags", "xxhash"},
    "giraff_keyboard": {"rich"},
}
"""What only requirements/recorder.lock, web.lock, localization.lock, camera.lock, ros2.lock and laptop.lock install."""


def test_the_robots_side_needs_the_robots_lock_only() -> None:
    shared, alone = ["giraff_schemas", "giraff_core", "giraff_node"], ["giraff_client", *services()]
    run = finished([sys.executable, "-c", LOAD, " ".join(shared), " ".join(alone)], check=True)
    loaded = {package: set(names) for package, names in map(json.loads, run.stdout.splitlines())}
    assert set(loaded) == {*shared, *alone}
    foreign = {package: names - ROBOT_SIDE for package, names in loaded.items()}
    assert not {package: names for package, names in foreign.items() if names - OF_ONE_SERVICE.get(package, set())}
    assert all(foreign[package] for package in OF_ONE_SERVICE), "what does not belong on every robot shows"
