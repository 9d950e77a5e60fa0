"""Whatever else names the services agrees with their table: sources, deployment, robot file, simulation."""

from __future__ import annotations

import re
import tomllib
from collections import Counter
from importlib import import_module
from typing import Any
from unittest.mock import MagicMock

import pytest

from giraff_cli.doctor.findings import NEEDED
from giraff_cli.run.simulated_robot import START_ORDER
from giraff_keyboard.view import DriveView
from giraff_node.config import misplaced
from giraff_node.config.robot_file import TABLES, load
from giraff_schemas import topics
from giraff_schemas.boards import BOARDS
from giraff_schemas.services import CLIENT, DOOR, HANDS, INSTALLED, ROBOTS_OWN, SERVICES, SIMULATED, Service
from giraff_schemas.trouble import Trouble
from giraff_sim.dst.faults import machine, robot
from giraff_sim.settings import MACHINES, Services, Settings
from tests.rules.repository import ROOT, packages, sources
from tests.support.robots import ROBOT

IN_PACKAGES = [service for service in SERVICES if service.package]
TURNING = [service for service in IN_PACKAGES if (ROOT / "services" / service.package / "service.py").exists()]
COMPOSE = (ROOT / "docker-compose.yml").read_text()
COMPOSED = dict(
    re.findall(r"^  (\w+):\n((?:    .*\n|\n|  #.*\n)+)", COMPOSE.partition("\nservices:\n")[2], re.MULTILINE)
)
"""By name: its lines in the compose file."""
PROFILES = dict.fromkeys(INSTALLED, "robot") | {"joystick": "laptop"}
"""Others have one of their own, by which they are added to a host."""


def test_each_package_of_a_service_is_in_the_table() -> None:
    def is_service(package: str) -> bool:
        return all((ROOT / "services" / package / f"{part}.py").exists() for part in ("config", "policy", "main"))

    packaged = {package for package in packages() if is_service(package)}
    assert {service.package for service in IN_PACKAGES} == packaged | {DOOR.package}  # which decides nothing


def test_no_name_is_there_twice() -> None:
    names = [service.name for service in SERVICES]
    assert len(names) == len(set(names))


def needed(service: Service) -> dict[str, str]:
    """What a service cannot do without, as variables."""
    given = {"guard": {"DECELERATION": "1.5"}}.get(service.name, {})
    port = {"PORT": "/dev/giraff"} if service.board is not None or service.name == "gateway" else {}
    return {f"GIRAFF_{service.table.upper()}_{field}": value for field, value in (given | port).items()}


@pytest.mark.parametrize("service", IN_PACKAGES, ids=lambda service: service.name)
def test_the_shipped_robot_file_has_its_table(service: Service) -> None:
    tables = tomllib.loads((ROOT / "deploy" / "robot.toml").read_text())
    assert service.table in tables or service.host == "router"


@pytest.mark.parametrize("service", IN_PACKAGES, ids=lambda service: service.name)
def test_compose_starts_it(service: Service) -> None:
    lines = COMPOSED[service.name]
    assert f"command: [python, -m, {service.package}]\n" in lines
    assert f"profiles: [{PROFILES.get(service.name, service.name)}]\n" in lines
    asks = f"giraff_health/ask.py, {service.name}]"
    assert (asks in lines) is (service.name != "keyboard")  # which a person looks at
    assert ("<<: *board" in lines) is (service.board is not None or service.name == "gateway")


def test_compose_asks_each_part_of_a_simulated_robot_how_it_is() -> None:
    asked = re.search(r"for service in ([\w ]+);", COMPOSED["sim"])
    assert asked is not None
    assert set(asked[1].split()) == set(SIMULATED)


def test_install_starts_what_a_robots_computer_runs_and_the_hand_with_a_board() -> None:
    install = (ROOT / "scripts" / "install").read_text()
    roles = {role: set(names.split()) for role, names in re.findall(r"(\w+)\) SERVICES=\(([\w ]+)\)", install)}
    boards = {service.name for service in SERVICES if service.host == "operator" and service.board is not None}
    assert roles == {"robot": set(INSTALLED), "laptop": boards}


def test_the_units_file_names_them() -> None:
    unit = (ROOT / "deploy" / "systemd" / "giraff@.service").read_text().splitlines()[0]
    robots, laptops = unit.partition(" on the robot")[::2]
    assert set(re.findall(r"@(\w+)", robots)) == set(INSTALLED)
    assert set(re.findall(r"@(\w+)", laptops)) == {"joystick"}


def test_the_same_run_everywhere() -> None:
    assert set(MACHINES) == set(Services._fields) == set(START_ORDER) == set(SIMULATED)
    assert set(Settings.__struct_fields__) == {"robot", *SIMULATED}


@pytest.mark.parametrize("service", [service for service in SERVICES if service.simulated], ids=lambda one: one.name)
def test_each_runs_on_its_machine(service: Service) -> None:
    assert MACHINES[service.name] == service.host


def test_faults_are_drawn_of_services_that_are_there() -> None:
    boards = {service.name: service.host for service in SERVICES if service.board is not None}
    assert {name: host for host, names in machine.WITH_A_BOARD.items() for name in names} == boards
    assert {service.board: service.name for service in SERVICES if service.board is not None} == robot.SERVED
    assert set(machine.IN_THE_CHAIN) == set(SIMULATED) - {"odometry", "motion"}


def test_doctor_tells_what_follows_where_one_is_missing() -> None:
    assert set(NEEDED) == {*ROBOTS_OWN, DOOR.name}


def test_a_hand_is_what_a_person_drives_by() -> None:
    assert HANDS == ("joystick", "keyboard", "web")


@pytest.mark.parametrize("service", TURNING, ids=lambda service: service.name)
def test_it_declares_what_the_table_says(service: Service) -> None:
    config = misplaced.config_of(service.table)
    made = getattr(import_module(f"{service.package}.service"), service.name.capitalize())
    io = MagicMock(instance="one", hostname="host")
    io.store.read.side_effect = FileNotFoundError
    io.token.return_value = 1
    people: dict[str, tuple[Any, ...]] = {
        "keyboard": (MagicMock(topics=DriveView.topics),),  # its screen
        "web": (MagicMock(), MagicMock()),  # its pages and its log
        "localization": (Trouble("there is none"),),  # its map
    }
    given = load(service.table, config, {"GIRAFF_CONFIG": str(ROOT / "deploy" / "robot.toml"), **needed(service)})
    made(io, given, ROBOT, *people.get(service.name, ()))
    for method, rows in ((io.publisher, service.publishes), (io.inbox, service.subscribes)):
        assert {topics.topic_of(call.args[0].key) for call in method.call_args_list} == set(rows)
    assert {call.args[0] for call in io.requests.call_args_list} == set(service.answers)
    boards = [call.args[1] for call in io.board.call_args_list]
    assert boards == ([] if service.board is None else [BOARDS[service.board]])


@pytest.mark.parametrize("service", [each for each in IN_PACKAGES if each not in TURNING], ids=lambda each: each.name)
def test_so_does_one_with_a_loop_of_its_own(service: Service) -> None:
    main = (ROOT / "services" / service.package / "main.py").read_text()
    for method, declared in (("publisher", service.publishes), ("inbox", service.subscribes)):
        names = set(re.findall(rf"node\.{method}\((\w+)", main))
        assert {getattr(topics, name).key for name in names} == {topic.key for topic in declared}


def test_a_script_hears_what_it_can_read_and_what_its_policy_takes() -> None:
    sources = ROOT / "services" / "giraff_client"
    readers = "".join((sources / name).read_text() for name in ("robot.py", "states.py"))
    read = {getattr(topics, name) for name in re.findall(r"\b_fresh\(([A-Z_]+),", readers)}
    taken = set(re.findall(r"case (\w+)\(\):", (sources / "policy.py").read_text()))
    assert read
    assert set(CLIENT.subscribes) == {
        topics.RANGE,
        *read,
        *(topic for topic in topics.TOPICS if topic.schema.__name__ in taken),
    }


def test_nothing_that_a_robot_runs_hears_the_truth() -> None:
    """It is for people who look on: a policy that knew it would be right in the simulation alone."""
    assert [service.name for service in SERVICES if topics.TRUE_POSE in service.subscribes] == []
    named = {
        path.relative_to(ROOT).parts[1]
        for path in sources(".py", under=("services",))
        if re.search(r"\b(TRUE_POSE|TruePose)\b", path.read_text())
    }
    assert named == {"giraff_cli", "giraff_viewer"}


def test_each_table_of_the_robot_file_has_a_configuration() -> None:
    configs = {table: misplaced.config_of(table) for table in TABLES if table != "network"}
    assert {table: config.__name__ for table, config in configs.items()} == {
        table: f"{table.capitalize()}Config" for table in configs
    }


def test_only_commands_have_several_makers() -> None:
    """`doctor` asks the one maker of a topic why it is silent."""
    makers = Counter(topic.key for service in SERVICES for topic in service.publishes)
    assert {key for key, count in makers.items() if count > 1} == {topics.OPERATOR_CMD_VEL.key}
