"""What is wrong with a robot and its machines, each with its way out: facts in, findings out."""

from collections.abc import Iterator
from typing import Final, Literal

import msgspec

from giraff_cli.doctor.inspection import (
    Geometry,
    HealthReply,
    Inspection,
    Machine,
    Network,
    Probe,
    Rate,
    Robot,
    as_lines,
)
from giraff_core.kinematics.calibration import Calibration
from giraff_core.lease import unranked_notice
from giraff_core.network import HAND_PORTS, IPV4_ALONE
from giraff_core.senses import PUBLISHERS
from giraff_node.network.reach import NO_NAME
from giraff_schemas.actions import ANY
from giraff_schemas.services import BASE, DOOR, HANDS, ODOMETRY, PLAY, ROBOTS_OWN, ROS2, RUN, SERVICES
from giraff_schemas.trouble import Trouble
from giraff_telemetry.describe import START_A_HAND
from giraff_tools.network.interfaces import no_network
from giraff_tools.network.versions import version_trouble
from giraff_tools.terminal.text import json_page

Severity = Literal["fault", "warning", "note"]

CLOCKS_APART: Final = 0.5  # s; recordings and logs of two machines can no longer be laid beside each other
_DISK_FULL: Final = 50_000_000  # bytes
_DISK_LOW: Final = 500_000_000
_SLOW: Final = 0.7  # of the rate in the topics table
_LOSSY: Final = 0.02
_FEW: Final = 5  # samples that tell nothing about a rate

_SEE_LOG: Final = "see its log"
_START: Final = "systemctl enable --now giraff@{service}, or docker-compose up -d {service}"
_MISSED: Final = {service.name: service.missing for service in SERVICES if service.missing is not None}


class Finding(msgspec.Struct, frozen=True, kw_only=True):
    """One thing that is wrong, or worth knowing."""

    severity: Severity
    about: str
    what: str
    fix: str


def findings(look: Inspection) -> list[Finding]:
    """All of them, the gravest first."""
    found = [*_of_machine(look.machine), *_of_network(look)]
    if look.robot is None:
        found += _of_silence(look)
    else:
        found += [*_of_services(look.robot, look.network), *_of_answers(look.robot, look.machine)]
        found += [*_of_geometries(look.robot, look.machine), *_of_rates(look.robot, look.machine)]
        found += _of_state(look.robot)
    order = ("fault", "warning", "note")
    return sorted(dict.fromkeys(found), key=lambda each: order.index(each.severity))


def _of_machine(machine: Machine) -> Iterator[Finding]:
    if machine.settings_problem:
        yield _told("fault", "robot file", machine.settings_problem)
    if machine.keys_problem:
        yield _told("fault" if machine.keys_expired else "warning", "certificates", machine.keys_problem)
    for port in machine.ports:
        if port.problem:
            yield _told("fault", f"{port.service}'s board", port.problem)
    for disk in machine.disks:
        if disk.problem:
            yield _told("fault", "disk", disk.problem)
        elif disk.free_bytes < _DISK_LOW:
            grave: Severity = "fault" if disk.free_bytes < _DISK_FULL else "warning"
            left = f"{disk.folder}: {disk.free_bytes / 1e6:.0f} MB of {disk.total_bytes / 1e6:.0f} MB are free"
            yield Finding(severity=grave, about="disk", what=left, fix="delete old recordings, or move them elsewhere")
    if machine.wiring_problem:
        what = "how motors and encoders are soldered is not known, so base does not arm"
        fix = machine.wiring_problem.to_do(ANY)
        yield Finding(severity="warning", about="wiring", what=what, fix=fix)
    yield from (_told("warning", "operator", unranked_notice(operator)) for operator in machine.unranked_hands)


def _of_silence(look: Inspection) -> Iterator[Finding]:
    """Why no robot is heard: the first cause that explains it."""
    network, found = look.network, False
    whom = f"no robot called {look.wanted} is heard" if look.wanted else "no robot is heard"
    for about, what, fix in _causes(look):
        found = True
        yield Finding(severity="fault", about=about, what=f"{whom}: {what}", fix=fix)
    if not found:
        what = f"{network.door} answers, but runs no service of it" if network.door else "nobody answers"
        what = f"{whom}: {what}{' by multicast' if network.scouted and not network.door else ''}"
        fix = "see that it is on and its services run; where the network blocks multicast, give --connect ADDRESS"
        yield Finding(severity="fault", about="network", what=what, fix=fix)


def _causes(look: Inspection) -> Iterator[tuple[str, str, str]]:
    machine, network = look.machine, look.network
    for problem in filter(None, (machine.loopback_problem, network.problem)):
        yield "network", problem.what, problem.to_do(ANY) or _SEE_LOG
    for call in network.calls:
        if told := _of_call(call, look):
            yield told
    if network.problem:
        return
    if others := [name for name in network.robots if name != look.wanted]:
        yield "network", f"there is {', '.join(others)}", f"name the one you mean: --robot {others[0]}"
    elif not network.has_doors:
        return
    elif not machine.interfaces:
        trouble = no_network(machine.ipv6_alone)
        yield "network", trouble.what, trouble.to_do(ANY)
    elif network.protocols and network.protocol not in network.protocols:
        theirs = " and ".join(network.protocols)
        secured = "secured" if "tls" in network.protocols else "lan or fixed"
        what = f"others answer, but speak {theirs}, and this machine {network.protocol}"
        yield "network", what, f"set mode in [network] of this machine's robot file to {secured}, as theirs is"
    elif deaf := [each.name for each in machine.interfaces if not each.multicast]:
        what = f"interface {', '.join(deaf)} does not do multicast, by which robots are found"
        yield "network", what, f"ip link set {deaf[0]} multicast on; or give --connect ADDRESS"


def _of_call(call: Probe, look: Inspection) -> tuple[str, str, str] | None:
    machine = look.machine
    where = ", ".join(f"{each.name} {each.address}" for each in machine.interfaces) or "none of IPv4"
    port = call.address.rpartition(":")[2]
    match call.outcome:
        case "untrusted":
            return "certificates", f"{call.address}: {call.detail}", _trust(call.detail)
        case "refused" | "silent" | "no way" if call.address.startswith("["):
            fix = f"{IPV4_ALONE.remedy}; where it is a router's, see that it is on and listens there"
            return "network", f"{call.address} does not answer, and {IPV4_ALONE.what}", fix
        case "refused":
            here = f"{', '.join(machine.services)} run on this machine, but " if machine.services else ""
            what = f"{here}{call.address} refuses: no door listens"
            return "door", what, f"start it there: {_START.format(service=DOOR.name)}; or correct the address"
        case "answers" if look.network.has_doors and not look.network.door and not look.network.problem:
            what = f"{call.address} answers, but is no door: another program, or one that hangs"
            return "door", what, f"see there who listens: ss -ltnp 'sport = :{port}'"
        case "no name":
            return "network", f"{call.address.rpartition(':')[0]}: {NO_NAME.what}", NO_NAME.remedy
        case "silent" | "no way" if not call.on_link:
            what = f"{call.address} does not answer, and is in none of this machine's networks ({where})"
            return "network", what, "correct the address, or join the robot's network"
        case "silent" | "no way":
            what = f"{call.address} does not answer, though it is in a network of this machine ({where})"
            fix = f"see that it is on, that the address is its own, and that its firewall lets in {port}/tcp"
            return "network", what, fix
        case _:
            return None


def _trust(detail: str) -> str:
    if "expired" in detail or "not yet valid" in detail:
        return "giraff keys list tells whose: renew it with giraff keys host NAME --renew, and see the clocks"
    return "make both hosts' bundles with the same giraff keys folder, and copy them again"


def _of_network(look: Inspection) -> Iterator[Finding]:
    network = look.network
    if network.scouted and network.is_far and not network.is_found:
        what = "multicast does not get through: the robot is reached by its address, and not found without it"
        fix = "keep its address in connect of [network] on each machine; or let switch and firewall pass 224.0.0.224"
        yield Finding(severity="fault", about="network", what=what, fix=fix)
    if network.untold:
        is_run = look.robot is not None and look.robot.services.get(RUN.name)
        restart = "systemctl restart giraff@door, or docker-compose restart door"
        what = f"{', '.join(network.untold)} of this machine came after its door, which does not announce it"
        fix = "end giraff run, and start it again" if is_run else f"restart the door: {restart}"
        yield Finding(severity="fault", about="door", what=what, fix=fix)
    if not network.has_free_port:
        what = f"the ports {HAND_PORTS[0]} to {HAND_PORTS[-1]} of this machine are taken: no hand can start here"
        fix = f"end one of those who listen: ss -ltnp 'sport >= {HAND_PORTS[0]} and sport <= {HAND_PORTS[-1]}'"
        yield Finding(severity="warning", about="network", what=what, fix=fix)
    for page in network.pages:
        if page.outcome in ("silent", "no way"):
            host, _, port = page.address.rpartition(":")
            what = f"giraff_web runs on {host}, but {page.address} does not answer: no browser reaches the page"
            fix = f"let the firewall of {host} pass {port}/tcp"
            yield Finding(severity="warning", about="page", what=what, fix=fix)


def _of_services(robot: Robot, network: Network) -> Iterator[Finding]:
    doors = (DOOR.name, PLAY.name)
    has_door = not network.has_doors or any(robot.services.get(each) for each in doors)
    for service, (severity, so) in _MISSED.items():
        is_missed = service not in robot.unused and not (service == DOOR.name and has_door)
        if is_missed and not robot.services.get(service):
            what = f"giraff_{service} is not running, or hangs: {so}"
            fix = f"start it on the robot's machine: {_START.format(service=service)}"
            yield Finding(severity=severity, about=service, what=what, fix=fix)
    if not any(robot.services.get(hand) for hand in (*HANDS, ROS2.name)):
        what = "nobody is there who could drive"
        yield Finding(severity="warning", about="operator", what=what, fix=START_A_HAND)
    doubled = [service for service in ROBOTS_OWN if robot.services.get(service, 0) > 1]
    if len(doubled) > 1:
        what = f"two robots are called {robot.name}: several {', '.join(doubled)}{_on(robot, doubled)}"
        fix = "give one of them another name in [robot] of its robot file, and restart its services"
        yield Finding(severity="fault", about="robot", what=what, fix=fix)
    elif doubled:
        (service,) = doubled
        what = f"{robot.services[service]} giraff_{service} run for {robot.name}{_on(robot, doubled)}"
        fix = "end all but one; the robot does not drive while two decide"
        yield Finding(severity="fault", about=service, what=what, fix=fix)


def _on(robot: Robot, services: list[str]) -> str:
    """Where they are, as far as they tell."""
    places = [
        f"{each.health.service} on {each.health.host}, pid {each.health.pid}"
        for each in robot.answers
        if each.health.service in services
    ]
    return f" ({'; '.join(sorted(places))})" if places else ""


def _of_answers(robot: Robot, machine: Machine) -> Iterator[Finding]:
    for answer in robot.answers:
        who = f"{answer.health.service} on {answer.health.host}"
        yield from (_told("fault", who, fault) for fault in answer.health.faults)
        if answer.health.service not in HANDS:  # theirs tell why nobody drives, which is giraff why's to tell
            yield from (_told("warning", who, notice) for notice in answer.health.notices)
    told = {answer.health.service for answer in robot.answers}
    for service in sorted(service for service, count in robot.services.items() if count and service not in told):
        what = (
            f"giraff_{service} is there, but does not answer: it hangs, is of another version, or the network "
            "lets only one way through"
        )
        fix = "see its log, restart it; see that no firewall drops its answers, and one version is on all hosts"
        yield Finding(severity="fault", about=service, what=what, fix=fix)
    yield from _of_clocks(robot.answers, machine)
    yield from _of_versions(robot.answers, machine)


def _of_clocks(answers: tuple[HealthReply, ...], machine: Machine) -> Iterator[Finding]:
    worst: dict[str, HealthReply] = {}
    for answer in answers:
        before = worst.get(answer.health.host)
        if before is None or abs(answer.ahead) > abs(before.ahead):
            worst[answer.health.host] = answer
    for host, answer in worst.items():
        if abs(answer.ahead) - answer.uncertainty > CLOCKS_APART:
            side = "ahead of" if answer.ahead > 0.0 else "behind"
            what = f"the clock of {host} is {abs(answer.ahead):.1f} s {side} this machine's ({machine.host})"
            fix = "let both keep time by the network: timedatectl set-ntp true"
            yield Finding(severity="fault", about="clock", what=what, fix=fix)


def _of_versions(answers: tuple[HealthReply, ...], machine: Machine) -> Iterator[Finding]:
    if trouble := version_trouble(machine.host, machine.version, (answer.health for answer in answers)):
        yield _told("fault", "version", trouble)


def _of_geometries(robot: Robot, machine: Machine) -> Iterator[Finding]:
    """A process that was not restarted since the robot file was changed goes by what it has read."""
    stale = [each for each in robot.geometries if each.host == machine.host and _is_stale(each.geometry, machine)]
    if stale and machine.geometry is not None:
        services = sorted({each.service for each in stale})
        fields = {field: each.geometry for each in stale for field in _apart(each.geometry, machine.geometry)}
        told = "; ".join(
            f"{field} {_shown(old, field)}, now {_shown(machine.geometry, field)}" for field, old in fields.items()
        )
        what = f"{', '.join(services)} {'goes' if len(services) == 1 else 'go'} by the geometry from before: {told}"
        fix = _restart(services, robot)
        yield Finding(severity="warning", about="geometry", what=what, fix=fix)
    others = [each for each in robot.geometries if each not in stale]
    for field in sorted({field for each in others for field in _apart(each.geometry, others[0].geometry)}):
        who: dict[str, list[str]] = {}
        for each in others:
            who.setdefault(_shown(each.geometry, field), []).append(f"{each.service} on {each.host}")
        values = "; ".join(f"{value} in {', '.join(services)}" for value, services in who.items())
        fix = "give all hosts the same robot file, and restart the services at rest"
        yield Finding(severity="warning", about="geometry", what=f"{field} differs: {values}", fix=fix)


def _restart(services: list[str], robot: Robot) -> str:
    if robot.services.get(RUN.name):
        return "end giraff run, and start it again"
    units = " ".join(f"giraff@{service}" for service in services)
    them = "it" if len(services) == 1 else "them"
    return f"restart {them} at rest: systemctl restart {units}, or docker-compose restart"


def _is_stale(geometry: Geometry, machine: Machine) -> bool:
    return machine.geometry is not None and geometry != machine.geometry


def _apart(one: Geometry, other: Geometry) -> list[str]:
    """The fields in which they differ."""
    return [field for field in Geometry.__struct_fields__ if getattr(one, field) != getattr(other, field)]


def _shown(geometry: Geometry, field: str) -> str:
    value = getattr(geometry, field)
    if isinstance(value, Calibration):
        left, right, track = value.scales
        if value == Calibration():
            return "none"
        return f"{value.date or 'of no date'} (wheels {left:.5g} {right:.5g}, track {track:.5g})"
    return f"{value:.6g}"


def _of_rates(robot: Robot, machine: Machine) -> Iterator[Finding]:
    """Yield those of services of this version that say they are well: what is wrong with others is told already."""
    unwell = {answer.health.service for answer in robot.answers if not answer.health.ok}
    if BASE.name in unwell or not robot.services.get(BASE.name):
        unwell |= {ODOMETRY.name}  # it lives by base's wheels
    healths = (answer.health for answer in robot.answers)
    well = {health.service for health in healths if health.version == machine.version} - unwell
    for rate in robot.rates:
        if rate.maker in well and robot.services.get(rate.maker) == 1:
            yield from _of_rate(rate)


def _of_rate(rate: Rate) -> Iterator[Finding]:
    if not rate.heard:
        what = f"{rate.key} is silent, though giraff_{rate.maker} says it is well"
        anew = "; restart it if the robot file has changed" if rate.maker in PUBLISHERS.values() else ""
        yield Finding(severity="fault", about=rate.maker, what=what, fix=f"see the log of giraff_{rate.maker}{anew}")
    elif rate.heard >= _FEW and rate.hz is not None and rate.hz < _SLOW * rate.wanted_hz:
        what = f"{rate.key} comes at {rate.hz:.0f} Hz instead of {rate.wanted_hz:.0f}"
        fix = f"the machine of giraff_{rate.maker} is overloaded: see what else runs there"
        yield Finding(severity="fault", about=rate.maker, what=what, fix=fix)
    if rate.heard >= _FEW and rate.lost > max(_FEW, _LOSSY * (rate.heard + rate.lost)):
        what = f"{rate.key}: {rate.lost} of {rate.heard + rate.lost} samples were lost on the way"
        yield Finding(severity="fault", about="network", what=what, fix="better Wi-Fi, or a cable")


def _of_state(robot: Robot) -> Iterator[Finding]:
    if robot.estop is not None and robot.estop.engaged:
        why = robot.estop.reason
        what = f"the emergency stop is engaged by {robot.estop.by or 'nobody known'}: {why.what}"
        yield Finding(severity="note", about="e-stop", what=what, fix=why.to_do(ANY))


def _told(severity: Severity, about: str, trouble: Trouble) -> Finding:
    """What somebody has said."""
    return Finding(severity=severity, about=about, what=trouble.what, fix=trouble.to_do(ANY) or _SEE_LOG)


def as_document(look: Inspection, found: list[Finding]) -> str:
    """For programs."""
    told = {
        "robot": look.robot.name if look.robot else None,
        "host": look.machine.host,
        "faults": sum(each.severity == "fault" for each in found),
        "findings": found,
        "looked_at": as_lines(msgspec.to_builtins(look)),
    }
    return json_page(told)
