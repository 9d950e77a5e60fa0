"""Whatever else names the services agrees with their table: sources, deployment, robot file, simulation."""

import re
import sys
import tomllib
from collections import Counter
from typing import Any
from unittest.mock import MagicMock

import pytest

from giraff_base.drives.balancer.drive import BalancerDrive
from giraff_core.senses import SENSED
from giraff_keyboard.picture import DriveView
from giraff_node.config import typos
from giraff_node.config.robot_file import load
from giraff_node.process import libraries
from giraff_node.start import build
from giraff_schemas import topics
from giraff_schemas.boards import BOARDS
from giraff_schemas.services import (
    BASE,
    CLIENT,
    DOOR,
    GUARD,
    KEYBOARD,
    ROBOT_TABLES,
    ROBOTS_OWN,
    ROLES,
    SCAN,
    SERVICES,
    SIMULATED,
    WATCHED,
    Service,
)
from giraff_schemas.trouble import Trouble
from giraff_sim.dst.faults import machine
from giraff_sim.settings import Services, Settings
from tests.rules.repository import ROOT, imported_by, packages, pyproject, sources
from tests.support.robots import FITTED

IN_PACKAGES = [service for service in SERVICES if service.entry]
TURNING = [
    service
    for service in IN_PACKAGES
    if service.entry == "hand" or (ROOT / "services" / service.package / "service.py").exists()
]
COMPOSE = (ROOT / "docker-compose.yml").read_text()
COMPOSED = dict(
    re.findall(r"^  (\w+):\n((?:    .*\n|\n|  #.*\n)+)", COMPOSE.partition("\nservices:\n")[2], re.MULTILINE)
)
"""By name: its lines in the compose file."""
PROFILES = {service: role for role, services in ROLES.items() for service in services}
"""Others have one of their own, by which they are added to a host."""


def test_each_package_of_a_service_is_in_the_table() -> None:
    def is_service(package: str) -> bool:
        modules = {path.stem for path in (ROOT / "services" / package).glob("*.py")}
        return {"config", "hand"} <= modules or (
            "config" in modules and len({"policy", "service", "main"} & modules) > 1
        )

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


def require(holds: bool, file: str, lines: str) -> None:
    """Fail with the lines that a file lacks, as they can be copied into it."""
    if not holds:
        pytest.fail(f"{file} lacks:\n\n{lines}\n", pytrace=False)


@pytest.mark.parametrize("service", IN_PACKAGES, ids=lambda service: service.name)
def test_the_shipped_robot_file_has_its_table(service: Service) -> None:
    tables = tomllib.loads((ROOT / "deploy" / "robot.toml").read_text())
    require(service.table in tables or service.host == "router", "deploy/robot.toml", f"[{service.table}]")


@pytest.mark.parametrize("service", IN_PACKAGES, ids=lambda service: service.name)
def test_compose_starts_it(service: Service) -> None:
    code = ROOT / "services" / service.package / "service.py"
    has_port = service.board is not None or (code.exists() and "io.serial(" in code.read_text(encoding="utf-8"))
    wanted = f"""  {service.name}:
    <<: *{"board" if has_port else "service"}
    profiles: [{PROFILES.get(service.name, service.name)}]
    command: [python, -m, giraff_node, {service.name}]
"""
    if service != KEYBOARD:  # which a person looks at
        wanted += f"""    healthcheck:
      <<: *health
      test: [CMD, sh, /opt/giraff/src/services/giraff_health/wait.sh, {service.name}]
"""
    there = f"  {service.name}:\n{COMPOSED.get(service.name, '')}".replace("*control", "*service").splitlines()
    require(all(line in there for line in wanted.splitlines()), "docker-compose.yml", wanted)


def test_compose_asks_each_part_of_a_simulated_robot_how_it_is() -> None:
    asked = re.search(r"wait\.sh, ([\w, ]+)\]", COMPOSED["sim"])
    assert asked is not None
    wanted = f"      test: [CMD, sh, /opt/giraff/src/services/giraff_health/wait.sh, {', '.join(SIMULATED)}]"
    require({*asked[1].split(", ")} == {*SIMULATED}, "docker-compose.yml, at sim,", wanted)


def test_the_kernel_knows_each_kind_of_device_that_compose_permits() -> None:
    conf = (ROOT / "deploy" / "modules-load" / "giraff.conf").read_text()
    # A comment has a line of its own there, and each module one with the number of its devices before it.
    loaded = re.findall(r"^# (\d+): \w+\n\w+$", conf, re.MULTILINE)
    assert loaded
    assert {*loaded} == {*re.findall(r'"c (\d+):\* ', COMPOSE)}


@pytest.mark.parametrize("name", [each.name for each in SERVICES if each.simulated and each.entry == "service"])
def test_it_is_a_part_of_the_simulated_robot(name: str) -> None:
    made = name.capitalize()
    lines = f"""from giraff_{name}.config import {made}Config
from giraff_{name}.service import {made}
    {name}: {made}Config = {made}Config()
    {name}: Callable[[IO, {made}Config, RobotConfig], Service] = {made}"""
    there = {*Services._fields} & {*Settings.__struct_fields__}
    require(name in there, "services/giraff_sim/settings.py", lines)


def test_the_simulated_robot_has_no_other_part() -> None:
    assert {*Services._fields} == {*Settings.__struct_fields__} - {"robot"}
    assert {*Services._fields} <= {*SIMULATED}


def test_faults_end_what_drives_the_robot() -> None:
    assert {*machine.IN_THE_CHAIN} == {*WATCHED} - {"odometry"}


def test_doctor_tells_what_follows_where_one_is_missing() -> None:
    assert {service.name for service in SERVICES if service.missing is not None} == {*ROBOTS_OWN, DOOR.name, SCAN.name}


@pytest.mark.parametrize("service", TURNING, ids=lambda service: service.name)
def test_it_declares_what_the_table_says(service: Service) -> None:
    config = typos.config_of(service.table)
    io = MagicMock(instance="one", hostname="host")
    io.store.read.side_effect = FileNotFoundError
    io.token.return_value = 1
    people: dict[str, tuple[Any, ...]] = {
        "keyboard": (MagicMock(topics=DriveView.topics),),  # its screen
        "web": (MagicMock(), MagicMock()),  # its pages and its log
        "localization": (Trouble("there is none"),),  # its map
        "places": (Trouble("there is none"), None),  # its map, and its file
        "camera": (MagicMock(), MagicMock()),  # what sees, and its log
        "ros2": (MagicMock(**{"wall_ns.return_value": 0}),),  # a node of ROS
    }
    given = load(service.table, config, {"GIRAFF_CONFIG": str(ROOT / "deploy" / "robot.toml"), **needed(service)})
    build(service, io, given, FITTED, *people.get(service.name, ()))
    of_another_drive = set(BalancerDrive.topics) if service is BASE else set()
    for method, rows in ((io.publisher, {*service.publishes} - of_another_drive), (io.inbox, service.subscribes)):
        assert {topics.topic_of(call.args[0].key) for call in method.call_args_list} - of_another_drive == set(rows)
    assert of_another_drive <= set(service.publishes)
    assert {call.args[0] for call in io.requests.call_args_list} == set(service.answers)
    boards = [call.args[1] for call in io.board.call_args_list]
    assert boards == ([] if service.board is None else [BOARDS[service.board]])


@pytest.mark.parametrize("service", [each for each in IN_PACKAGES if each not in TURNING], ids=lambda each: each.name)
def test_so_does_one_with_a_loop_of_its_own(service: Service) -> None:
    main = (ROOT / "services" / service.package / "main.py").read_text()
    for method, declared in (("publisher", service.publishes), ("inbox", service.subscribes)):
        names = set(re.findall(rf"node\.{method}\((\w+)", main))
        assert {getattr(topics, name).key for name in names} == {topic.key for topic in declared}


@pytest.mark.parametrize("service", [each for each in SERVICES if each.libraries], ids=lambda each: each.name)
def test_its_package_imports_the_libraries_that_its_extra_brings(
    service: Service, monkeypatch: pytest.MonkeyPatch
) -> None:
    modules = (ROOT / "services" / service.package).rglob("*.py")
    imported = {each.partition(".")[0] for path in modules for each in imported_by(path.read_text())}
    everywhere = {"msgspec", "zenoh", *packages(), *sys.stdlib_module_names}
    assert set(service.libraries) == imported - everywhere
    brought = pyproject()["project"]["optional-dependencies"][service.extra]
    for library in service.libraries:
        monkeypatch.setattr(libraries, "find_spec", lambda name, missing=library: None if name == missing else name)
        distribution = libraries.missing_library(service).split()[2]
        assert distribution in {re.split(r"[^\w-]", each)[0] for each in brought}


def test_a_script_hears_what_it_can_read_and_what_its_policy_takes() -> None:
    sources = ROOT / "services" / "giraff_client"
    readers = "".join((sources / name).read_text() for name in ("robot.py", "reading.py"))
    read = {getattr(topics, name) for name in re.findall(r"\b_fresh\(([A-Z_]+),", readers)}
    taken = set(re.findall(r"case (\w+)\(\):", (sources / "policy.py").read_text()))
    assert read
    assert set(CLIENT.subscribes) == {
        *SENSED.values(),
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
    configs = {table: typos.config_of(table) for table in ROBOT_TABLES if table != "network"}
    assert {table: config.__name__ for table, config in configs.items()} == {
        table: f"{table.capitalize()}Config" for table in configs
    }


def test_only_what_operators_say_has_several_makers() -> None:
    """`doctor` asks the one maker of a topic why it is silent."""
    makers = Counter(topic.key for service in SERVICES for topic in service.publishes)
    several = (topics.OPERATOR_CMD_VEL, topics.MOTION_HOLD, topics.PLACES_HOLD)
    assert {key for key, count in makers.items() if count > 1} == {topic.key for topic in several}


def test_the_guard_hears_what_each_sense_tells_and_nothing_else_of_a_sensor() -> None:
    assert {*SENSED.values()} == {topic for topic in GUARD.subscribes if topic.names == "sensor"}
    for topic in SENSED.values():
        [maker] = [service for service in SERVICES if topic in service.publishes]
        assert (topic.inside, maker.inside) == (True, True)
        assert {"sensor", "tick"} <= {*topic.schema.__struct_fields__}
