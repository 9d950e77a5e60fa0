"""What `giraff doctor` concludes from facts."""

import fcntl
import socket
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import msgspec
import pytest

from giraff_cli.doctor import machine, probe
from giraff_cli.doctor.findings import as_document, findings
from giraff_cli.doctor.inspection import (
    Disk,
    Geometry,
    GeometryInUse,
    HealthReply,
    Inspection,
    Machine,
    Network,
    Port,
    Probe,
    Rate,
    Robot,
)
from giraff_cli.doctor.machine import geometry_of, look_at_boards, look_at_machine, wiring_problem
from giraff_cli.doctor.robot import geometry_in
from giraff_core.kinematics.calibration import Calibration
from giraff_core.network import NetworkConfig
from giraff_core.parameters.table import Parameters
from giraff_node.network.discovery import simulated_name
from giraff_node.network.sockets import live_sockets, own_socket, socket_folder
from giraff_odometry.config import OdometryConfig
from giraff_schemas.health import Health
from giraff_schemas.params import ParamAnswer
from giraff_schemas.trouble import NO_TROUBLE, Trouble
from giraff_tools.network.interfaces import Interface, is_own, on_link
from tests.rules.repository import ROOT
from tests.support.robots import ROBOT as ODOMETRYS
from tests.unit.cli.samples import base, estop

BAD = Trouble("it is bad", "mend it")
SERVICES = ("base", "door", "guard", "joystick", "odometry", "ranger")
UPLINK = Interface(name="uplink", address="10.71.1.2/24", multicast=True)
DISK = Disk(folder="/var/lib/giraff", free_bytes=10**9, total_bytes=10**10)
MACHINE = Machine(host="pc", version="0.1.0-aa", interfaces=(UPLINK,), disks=(DISK,))
NETWORK = Network(robots=("anne",), door="10.71.1.9:7447", is_far=True, scouted=True, is_found=True)


def answer(service: str, ahead: float = 0.0, **fields: Any) -> HealthReply:
    health = Health(
        service=service, instance=service, host="pc", pid=1, uptime=9.0, ok=True, faults=(), version="0.1.0-aa"
    )
    return HealthReply(health=msgspec.structs.replace(health, **fields), ahead=ahead, uncertainty=0.01)


ROBOT = Robot(
    name="anne",
    seconds=1.5,
    services=dict.fromkeys(SERVICES, 1),
    answers=tuple(answer(service) for service in SERVICES),
    unused=("scan",),
    rates=(Rate(key="cmd_vel", maker="guard", wanted_hz=50.0, hz=49.0, heard=75),),
    base=base(),
    estop=estop(),
)
HEALTHY = Inspection(machine=MACHINE, network=NETWORK, robot=ROBOT, wanted="anne")


def said(look: Inspection) -> list[str]:
    return [f"{each.severity} {each.about}: {each.what} -> {each.fix}" for each in findings(look)]


def of_machine(**fields: Any) -> Inspection:
    return msgspec.structs.replace(HEALTHY, machine=msgspec.structs.replace(MACHINE, **fields))


def of_network(**fields: Any) -> Inspection:
    return msgspec.structs.replace(HEALTHY, network=msgspec.structs.replace(NETWORK, **fields))


def of_robot(**fields: Any) -> Inspection:
    return msgspec.structs.replace(HEALTHY, robot=msgspec.structs.replace(ROBOT, **fields))


def answered(*changed: HealthReply) -> Inspection:
    names = {each.health.service for each in changed}
    return of_robot(answers=(*(each for each in ROBOT.answers if each.health.service not in names), *changed))


BUILT = Geometry(
    track_width=0.47,
    ticks_per_metre=2000.0,
    calibration=Calibration(date="2026-11-25", left_wheel_scale=1.01, right_wheel_scale=0.99, track_scale=1.02),
)
MEASURED = msgspec.structs.replace(BUILT, track_width=0.48)


def going_by(by_service: dict[str, Geometry], filed: Geometry | None = None, elsewhere: str = "") -> Inspection:
    """Services that have read these; `filed`: what this machine's robot file says now; `elsewhere`: of them, one that
    runs on another machine."""
    told = tuple(
        GeometryInUse(service=service, host="laptop" if service == elsewhere else "pc", geometry=geometry)
        for service, geometry in by_service.items()
    )
    robot = msgspec.structs.replace(ROBOT, geometries=told)
    return msgspec.structs.replace(HEALTHY, robot=robot, machine=msgspec.structs.replace(MACHINE, geometry=filed))


def simulated(look: Inspection) -> Inspection:
    """By a `giraff run`, which is there, too."""
    assert look.robot is not None
    services = {**look.robot.services, "run": 1}
    return msgspec.structs.replace(look, robot=msgspec.structs.replace(look.robot, services=services))


def rated(**fields: Any) -> Inspection:
    return of_robot(rates=(msgspec.structs.replace(ROBOT.rates[0], **fields),))


def silent(machine: Machine = MACHINE, **fields: Any) -> Inspection:
    network = msgspec.structs.replace(Network(), **fields)
    return Inspection(machine=machine, network=network, robot=None, wanted="anne")


def call(outcome: Any, detail: str = "", *, on_link: bool = True, address: str = "10.71.1.9:7447") -> tuple[Probe, ...]:
    return (Probe(address=address, outcome=outcome, detail=detail, on_link=on_link),)


@pytest.mark.parametrize(
    "look",
    [
        HEALTHY,
        answered(answer("joystick", 0.3, notices=("nobody drives; tilt",))),
        answered(msgspec.structs.replace(answer("base", 1.0), uncertainty=0.8)),
        of_network(pages=call("no name")),
        going_by({"base": BUILT, "odometry": BUILT}, filed=BUILT),
        going_by({"base": BUILT, "odometry": BUILT}),
    ],
    ids=["healthy", "operator's notice", "small difference of clocks", "page's name", "one geometry", "no file"],
)
def test_what_is_well_is_no_finding(look: Inspection) -> None:
    assert findings(look) == []


@pytest.mark.parametrize(
    ("look", "told"),
    [
        (of_machine(settings_problem=BAD), "fault robot file: it is bad -> mend it"),
        (of_machine(keys_problem=BAD, keys_expired=True), "fault certificates: it is bad -> mend it"),
        (of_machine(keys_problem=BAD), "warning certificates: it is bad -> mend it"),
        (of_machine(ports=(Port(service="base", problem=BAD),)), "fault base's board: it is bad -> mend it"),
        (of_machine(disks=(msgspec.structs.replace(DISK, free_bytes=10**7),)), "fault disk: /var/lib/giraff: 10 MB"),
        (of_machine(disks=(msgspec.structs.replace(DISK, free_bytes=10**8),)), "warning disk: /var/lib/giraff: 100 MB"),
        (
            of_machine(wiring_problem=BAD),
            "warning wiring: how motors and encoders are soldered is not known, so base does not arm -> mend it",
        ),
        (
            of_machine(unranked_hands=("gamepad",)),
            "warning operator: operator gamepad has no priority, so any person's hand takes the robot from it -> if a",
        ),
        (of_robot(services=ROBOT.services | {"guard": 0}), "fault guard: giraff_guard is not running, or hangs"),
        (of_robot(services=ROBOT.services | {"odometry": 0}), "warning odometry: giraff_odometry is not running"),
        (of_robot(services=ROBOT.services | {"joystick": 0}), "warning operator: nobody is there who could drive"),
        (of_robot(services=ROBOT.services | {"guard": 2}), "fault guard: 2 giraff_guard run for anne (guard on pc"),
        (of_robot(services=ROBOT.services | {"guard": 2, "base": 2}), "fault robot: two robots are called anne"),
        (of_robot(answers=ROBOT.answers[1:]), "fault base: giraff_base is there, but does not answer"),
        (answered(answer("base", ok=False, faults=(BAD,))), "fault base on pc: it is bad -> mend it"),
        (answered(answer("guard", notices=(Trouble("by", "it"),))), "warning guard on pc: by -> it"),
        (answered(answer("base", 2.0, host="old-pc")), "fault clock: the clock of old-pc is 2.0 s ahead of this"),
        (answered(answer("base", -2.0, host="old-pc")), "fault clock: the clock of old-pc is 2.0 s behind this"),
        (answered(answer("base", version="0.1.0-bb")), "fault version: versions differ: 0.1.0-aa on pc (door), "),
        (rated(hz=20.0), "fault guard: cmd_vel comes at 20 Hz instead of 50"),
        (rated(heard=0, hz=None), "fault guard: cmd_vel is silent, though giraff_guard says it is well"),
        (rated(lost=20), "fault network: cmd_vel: 20 of 95 samples were lost on the way"),
        (
            going_by({"base": MEASURED, "guard": MEASURED, "odometry": BUILT}),
            "warning geometry: track_width differs: 0.48 in base on pc, guard on pc; 0.47 in odometry on pc -> give",
        ),
        (
            going_by({"base": MEASURED, "odometry": msgspec.structs.replace(MEASURED, ticks_per_metre=2001.0)}),
            "warning geometry: ticks_per_metre differs: 2000 in base on pc; 2001 in odometry on pc",
        ),
        (
            going_by({"base": MEASURED, "odometry": msgspec.structs.replace(MEASURED, calibration=Calibration())}),
            "calibration differs: 2026-11-25 (wheels 1.01 0.99, track 1.02) in base on pc; none in odometry on pc",
        ),
        (
            going_by({"base": BUILT, "guard": MEASURED, "odometry": BUILT}, filed=MEASURED),
            "base, odometry go by the geometry from before: track_width 0.47, now 0.48 -> restart them at rest",
        ),
        (
            going_by({"base": MEASURED, "guard": BUILT}, filed=MEASURED),
            "guard goes by the geometry from before: track_width 0.47, now 0.48 -> restart it at rest",
        ),
        (
            simulated(going_by({"base": BUILT, "guard": MEASURED}, filed=MEASURED)),
            "base goes by the geometry from before: track_width 0.47, now 0.48 -> end giraff run, and start it again",
        ),
        (of_robot(estop=estop(engaged=True)), "note e-stop: the emergency stop is engaged by ann@desk: smoke"),
        (of_robot(estop=msgspec.structs.replace(estop(engaged=True), reason=BAD)), "desk: it is bad -> mend it"),
        (of_network(is_found=False), "fault network: multicast does not get through"),
        (of_network(untold=("10.72.1.2",)), "fault door: 10.72.1.2 of this machine came after its door, which"),
        (of_network(untold=("10.72.1.2",)), "restart the door: systemctl restart giraff@door"),
        (
            msgspec.structs.replace(
                simulated(HEALTHY), network=msgspec.structs.replace(NETWORK, untold=("10.72.1.2",), door="")
            ),
            "does not announce it -> end giraff run, and start it again",
        ),
        (of_network(has_free_port=False), "warning network: the ports 7448 to 7456 of this machine are taken"),
        (
            of_network(pages=call("silent")),
            "warning page: giraff_web runs on 10.71.1.9, but 10.71.1.9:7447 does not answer: no browser",
        ),
        (of_robot(services=ROBOT.services | {"door": 0}), "fault door: giraff_door is not running, or hangs: other"),
        (silent(), "fault network: no robot called anne is heard: nobody answers ->"),
        (silent(scouted=True), "fault network: no robot called anne is heard: nobody answers by multicast ->"),
        (silent(problem=BAD), "fault network: no robot called anne is heard: it is bad -> mend it"),
        (silent(robots=("otto",)), "there is otto -> name the one you mean: --robot otto"),
        (silent(msgspec.structs.replace(MACHINE, interfaces=())), "no interface is up"),
        (silent(protocols=("tls",)), "others answer, but speak tls, and this machine tcp"),
        (
            silent(msgspec.structs.replace(MACHINE, interfaces=(msgspec.structs.replace(UPLINK, multicast=False),))),
            "interface uplink does not do multicast",
        ),
        (silent(calls=call("refused")), "fault door: no robot called anne is heard: 10.71.1.9:7447 refuses: no door"),
        (
            silent(msgspec.structs.replace(MACHINE, services=("base", "guard")), calls=call("refused")),
            "base, guard run on this machine, but 10.71.1.9:7447 refuses: no door listens -> start it there: systemctl",
        ),
        (silent(calls=call("answers")), "10.71.1.9:7447 answers, but is no door: another program, or one that hangs"),
        (silent(calls=call("silent")), "does not answer, though it is in a network of this machine"),
        (silent(calls=call("silent")), "and that its firewall lets in 7447/tcp"),
        (silent(calls=call("no way", on_link=False)), "is in none of this machine's networks (uplink 10.71.1.2/24)"),
        (
            silent(calls=call("refused", address="[::1]:7447")),
            "[::1]:7447 does not answer, and robots listen at IPv4 alone -> give its IPv4 address; where",
        ),
        (
            silent(calls=call("no name", address="robot.lan:7447")),
            "robot.lan: no such name is known here (DNS, /etc/hosts) -> give its address",
        ),
        (
            silent(calls=call("untrusted", "self-signed")),
            "fault certificates: no robot called anne is heard: 10.71.1.9",
        ),
        (
            silent(calls=call("answers"), door="10.71.1.9:7447"),
            "fault network: no robot called anne is heard: 10.71.1.9:7447 answers, but runs no service of it",
        ),
    ],
)
def test_what_is_wrong_is_named_with_its_way_out(look: Inspection, told: str) -> None:
    assert any(told in each for each in said(look)), said(look)
    assert all(each.fix for each in findings(look))


def test_the_cause_is_told_and_not_what_comes_of_it() -> None:
    unwell = answered(answer("guard", ok=False, faults=(BAD,)))
    assert unwell.robot is not None
    rates = (msgspec.structs.replace(ROBOT.rates[0], heard=0, hz=None),)
    unwell = msgspec.structs.replace(unwell, robot=msgspec.structs.replace(unwell.robot, rates=rates))
    assert said(unwell) == ["fault guard on pc: it is bad -> mend it"]


def test_who_did_not_restart_is_told_once() -> None:
    assert len(findings(going_by({"base": BUILT, "odometry": MEASURED}, filed=MEASURED))) == 1


def test_this_machines_robot_file_says_nothing_of_another_machines_service() -> None:
    [told] = said(going_by({"base": MEASURED, "joystick": BUILT}, filed=MEASURED, elsewhere="joystick"))
    assert told.startswith("warning geometry: track_width differs: 0.48 in base on pc; 0.47 in joystick on laptop")


def test_a_geometry_is_taken_out_of_what_a_service_tells() -> None:
    robot = msgspec.structs.replace(ODOMETRYS, calibration=BUILT.calibration)
    params = Parameters("odometry", OdometryConfig(), robot).describe()
    answer = ParamAnswer(service="odometry", instance="o", host="pc", done=True, params=params)
    over_the_wire = msgspec.msgpack.decode(msgspec.msgpack.encode(answer), type=ParamAnswer)
    told = geometry_in(over_the_wire)
    assert (told.service, told.host) == ("odometry", "pc")
    assert told.geometry == Geometry(
        track_width=robot.track_width, ticks_per_metre=robot.ticks_per_metre, calibration=robot.calibration
    )


@pytest.mark.parametrize(
    ("robot", "is_its"), [("giraff", True), (simulated_name(socket.gethostname()), True), ("otto", False)]
)
def test_a_robot_file_is_its_robots_and_of_the_simulation_here(robot: str, is_its: bool) -> None:
    geometry = geometry_of(robot, {"GIRAFF_CONFIG": str(ROOT / "deploy" / "robot.toml")})
    assert (geometry is not None) == is_its
    assert geometry_of(robot, {"GIRAFF_CONFIG": "/dev/null"}) is None


def test_the_wiring_and_the_boards_of_the_file_are_not_those_of_a_simulated_robot(tmp_path: Path) -> None:
    (port := tmp_path / "port").touch()
    given = {"GIRAFF_CONFIG": str(ROOT / "deploy" / "robot.toml"), "GIRAFF_BASE_PORT": str(port)}
    assert (bool(wiring_problem((), given)), len(look_at_boards((), given))) == (True, 1)
    assert (wiring_problem(("run",), given), look_at_boards(("run",), given)) == (NO_TROUBLE, ())


@pytest.mark.parametrize(("field", "board"), [("BASE_DRIVE__BOARD", "mega_l298n"), ("RANGER_BOARD", "nano_ranger")])
def test_the_board_of_the_file_is_looked_for(
    field: str, board: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (port := tmp_path / "port").touch()
    monkeypatch.setattr(machine, "_greet", lambda _path, there: Trouble(there.name, "flash it"))
    given = {"GIRAFF_CONFIG": str(ROOT / "deploy" / "robot.toml"), f"GIRAFF_{field}": board}
    given[f"GIRAFF_{field.partition('_')[0]}_PORT"] = str(port)
    assert [each.problem.what for each in look_at_boards((), given)] == [board]


def test_the_port_of_a_process_is_missed_where_its_folder_is(tmp_path: Path) -> None:
    robot = ROOT / "deploy" / "robots" / "roboclaw.toml"
    given = {"GIRAFF_CONFIG": str(robot), "GIRAFF_BASE_PORT": str(tmp_path / "giraff-board" / "port")}
    assert look_at_boards(("ranger", "joystick"), given) == ()
    (tmp_path / "giraff-board").mkdir()
    [port] = look_at_boards(("ranger", "joystick"), given)
    assert "is not there: the process giraff-board@roboclaw does not run" in port.problem.what


@pytest.mark.parametrize(
    ("lines", "unranked"),
    [
        ("", ()),
        (
            '[joystick]\noperator = "gamepad"\n[web]\noperator = "keyboard"\n[keyboard]\noperator = "desk"',
            ("desk", "gamepad"),
        ),
        ('[joystick]\noperator = "gamepad"\n[guard.priorities]\ngamepad = 0', ()),
        ('[joystick]\noperator = "gamepad"\n[guard]\nmargin = 0', ()),
    ],
)
def test_the_robot_files_hands_are_held_against_its_priorities(
    tmp_path: Path, lines: str, unranked: tuple[str, ...]
) -> None:
    (file := tmp_path / "robot.toml").write_text(lines)
    assert look_at_machine("", NetworkConfig(), environment={"GIRAFF_CONFIG": str(file)}).unranked_hands == unranked


def test_doctor_reads_what_only_base_reads(tmp_path: Path) -> None:
    text = (ROOT / "deploy" / "robot.toml").read_text(encoding="utf-8")
    (file := tmp_path / "robot.toml").write_text(text.replace("max_level = 70", "max_level = 700"), encoding="utf-8")
    machine = look_at_machine("", NetworkConfig(), environment={"GIRAFF_CONFIG": str(file)})
    assert "table [base]: drive: max_level is 700: it must be within 1..255" in machine.settings_problem.what


def test_what_is_played_is_a_door_a_run_is_none_and_the_loopback_needs_none() -> None:
    answers = (*(each for each in ROBOT.answers if each.health.service != "door"), answer("play"))
    assert findings(of_robot(services=ROBOT.services | {"door": 0, "play": 1}, answers=answers)) == []
    assert "door" in {one.about for one in findings(of_robot(services=ROBOT.services | {"door": 0, "run": 1}))}
    local = of_robot(services={name: 1 for name in SERVICES if name != "door"}, answers=answers[:-1])
    assert findings(msgspec.structs.replace(local, network=Network(has_doors=False))) == []


def test_a_port_is_free_where_nobody_listens(monkeypatch: pytest.MonkeyPatch) -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        monkeypatch.setattr(probe, "ports_of", lambda *_: (port,))
        assert not probe.has_free_port(NetworkConfig())
    assert probe.has_free_port(NetworkConfig())


def test_parts_of_a_robot_run_where_their_sockets_are_in_use(tmp_path: Path) -> None:
    network = NetworkConfig(sockets=str(tmp_path))
    folder = socket_folder(network)
    with ExitStack() as held:
        for service in ("base", "joystick", "guard"):
            lock = held.enter_context(own_socket(folder, service).with_suffix(".lock").open("wb"))
            if service != "guard":
                fcntl.flock(lock, fcntl.LOCK_EX)
        assert live_sockets(folder) == ("base", "joystick")
        assert look_at_machine("", network).services == ("base",)
    assert look_at_machine("", network).services == ()


def test_the_gravest_comes_first() -> None:
    look = of_robot(estop=estop(engaged=True), services=ROBOT.services | {"odometry": 0, "guard": 0})
    assert [each.severity for each in findings(look)] == ["fault", "warning", "note"]


def test_addresses_are_told_apart() -> None:
    near = [each for each in ("10.71.1.9", "10.71.2.9", "127.0.0.1", "robot.lan") if on_link(each, (UPLINK,))]
    assert near == ["10.71.1.9", "127.0.0.1", "robot.lan"]
    own = [each for each in ("10.71.1.2", "10.71.1.9", "127.0.0.1", "[fe80::1%2]") if is_own(each, (UPLINK,))]
    assert own == ["10.71.1.2", "127.0.0.1", "[fe80::1%2]"]


def test_programs_read_a_problem_as_one_line() -> None:
    document = msgspec.json.decode(as_document(of_machine(settings_problem=BAD), []))
    assert document["looked_at"]["machine"]["settings_problem"] == "it is bad; mend it"
