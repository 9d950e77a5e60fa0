"""Faults of machines and processes, and too many of them."""

from random import Random
from typing import Final

from giraff_schemas.services import SERVICES
from giraff_sim.dst.hands import Fingers
from giraff_sim.dst.judging.stops import BEYOND_US, ROBOT_US
from giraff_sim.dst.people import double, keyboard_user
from giraff_sim.dst.simulated_run import Course, Kind, SimulatedRun, fault
from giraff_sim.settings import MACHINES
from giraff_sim.world.body import BoundedMotion

KINDS: Final[list[Kind]] = []

_HOUR_NS: Final = 3_600_000_000_000
IN_THE_CHAIN: Final = ("joystick", "guard", "base", "ranger")


_ALONE: Final = 0.5
_STOPPED: Final = 0.5
_SAVED: Final = 0.3
_PARAMETERS: Final = (
    ("guard", "margin", 0.40, 0.02),
    ("guard", "creep_linear", 0.05, 0.60),
    ("guard", "operator_budget", 0.25, 3.0),
    ("guard", "deceleration", 0.8, 9.0),
    ("base", "operator_budget", 0.25, 3.0),
    ("base", "range_budget", 0.30, 3.0),
    ("base", "arm_time", 0.40, 0.01),
    ("base", "linear_acceleration", 0.30, 5.0),
    ("joystick", "full_tilt_deg", 45.0, 15.0),
)
"""Service, name, a tighter value and one that is looser than the robot file's."""


def _bound(name: str) -> tuple[int, BoundedMotion]:
    """Within what a service's end stops the robot, and what motion."""
    if name == "ranger":
        return BEYOND_US, "travel"
    return (BEYOND_US, "any") if name == "joystick" else (ROBOT_US, "any")


@fault(KINDS, weight=4.0, lasts=(0.02, 3.0))
def kill(run: SimulatedRun, chance: Random) -> Course:
    name = chance.choice(IN_THE_CHAIN)
    if not run.claims(name):
        return
    applies = run.driven_by(name)
    bound_us, way = _bound(name)
    signal, end = chance.choice((("killed", run.loop.kill), ("terminated", run.loop.terminate)))
    end(name)
    with run.stops(f"{name} is {signal}", bound_us, way, applies):
        yield f"{name} is {signal}"
    run.loop.start(name)


@fault(KINDS, weight=4.0, lasts=(0.02, 4.0))
def pause(run: SimulatedRun, chance: Random) -> Course:
    name = chance.choice(IN_THE_CHAIN)
    if not run.claims(name):
        return
    process = run.loop.processes[name]
    process.paused = True
    bound_us, way = _bound(name)
    with run.stops(f"{name} is paused", bound_us, way, run.driven_by(name)):
        yield f"{name} is paused"
    process.paused = False
    process.go_on(chance.choice((0, 20_000, 200_000)))


@fault(KINDS, weight=2.0, lasts=(0.1, 5.0))
def suspend(run: SimulatedRun, chance: Random) -> Course:
    name = chance.choice(("operator", "robot"))
    host = run.loop.hosts[name]
    cables = [run.cable(each.name) for each in SERVICES if each.board is not None and each.host == name]
    if not run.claims(*cables, *(service for service, on in MACHINES.items() if on == name)):
        return
    host.suspend()
    for cable in cables:
        cable.holds_to_host = True
    bound_us = ROBOT_US if name == "robot" else BEYOND_US
    with run.stops(f"the {name}'s machine is suspended", bound_us, "any", lambda: name == "robot" or run.drives(name)):
        yield f"the {name}'s machine is suspended"
    host.resume()
    for cable in cables:
        cable.holds_to_host = False
    spread_us = chance.choice((0, 20_000, 300_000))
    for process in tuple(run.loop.processes.values()):
        if process.host is host:
            process.go_on(spread_us)


@fault(KINDS, weight=1.0, lasts=(0.0, 0.0))
def wall_clock(run: SimulatedRun, chance: Random) -> Course:
    name = chance.choice(("operator", "robot"))
    host = run.loop.hosts[name]
    host.wall_ahead_ns = chance.randint(-_HOUR_NS, _HOUR_NS)
    host.wall_drift = chance.uniform(-1e-3, 1e-3)
    yield f"the {name}'s wall clock jumps, to {host.wall_ahead_ns / 1e9:+.0f} s from the truth"


@fault(KINDS, weight=2.0, lasts=(0.3, 4.0))
def disk(run: SimulatedRun, chance: Random) -> Course:
    """Half of the time with an emergency stop that it is asked to keep."""
    disk = run.loop.hosts["robot"].disk
    if not run.claims(disk):
        return
    told = chance.choice(("hangs", "is full"))
    if told == "hangs":
        disk.hang()
    else:
        disk.trouble = "No space left on device"
    is_stopped = chance.random() < _STOPPED and run.claims(run.button)
    if is_stopped:
        run.button.engage()
        told += ", and somebody engages the emergency stop"
    yield f"the robot's disk {told}"
    disk.trouble = ""
    disk.go_on()
    if is_stopped:
        run.release_later()


@fault(KINDS, weight=2.0, lasts=(1.0, 6.0), calm_after=4.0)
def parameter(run: SimulatedRun, chance: Random) -> Course:
    """Tighter ones are taken back at the end; looser ones must be refused."""
    service, name, tighter, looser = chance.choice(_PARAMETERS)
    if not run.claims(f"{service}.{name}"):
        return
    filed = getattr(getattr(run.loop.settings, service), name)
    value = chance.choice((tighter, looser))
    run.estop_operator.set(service, name, value)
    is_saved = chance.random() < _SAVED
    if is_saved:
        run.estop_operator.save(service)
    yield f"somebody sets {service}.{name} to {value:g}" + (", and saves it" if is_saved else "")
    run.estop_operator.set(service, name, filed)
    if is_saved:
        run.estop_operator.save(service)


@fault(KINDS, weight=1.5, lasts=(0.1, 4.0), calm_after=4.0)
def second_guard(run: SimulatedRun, chance: Random) -> Course:
    del chance
    yield from _second(run, "guard", "")


@fault(KINDS, weight=1.5, lasts=(0.1, 4.0), calm_after=4.0)
def second_base(run: SimulatedRun, chance: Random) -> Course:
    del chance
    yield from _second(run, "base", "; the board's port is taken")


def _second(run: SimulatedRun, service: str, besides: str) -> Course:
    """Another process of a service of which there may be one."""
    if not run.claims(service):
        return
    name = run.fresh_name(f"second {service}")
    run.loop.start(service, name)
    with run.stops(f"{name} runs", ROBOT_US):
        yield f"a {name} starts{besides}"
    run.loop.kill(name)


@fault(KINDS, weight=1.5, lasts=(2.0, 8.0))
def second_joystick(run: SimulatedRun, chance: Random) -> Course:
    name = run.fresh_name("second joystick")
    run.loop.launch(name, lambda process: double(process, chance, run.seconds), run.loop.hosts["operator"])
    yield f"a {name} of the same name starts"
    run.loop.kill(name)


@fault(KINDS, weight=2.0, lasts=(3.0, 12.0))
def keyboard(run: SimulatedRun, chance: Random) -> Course:
    """Half of the time without a joystick: one that rests keeps the lease for longer than any run lasts."""
    name = run.fresh_name("keyboard")
    begin = run.loop.agenda.now_us * 1e-6
    fingers = Fingers(chance, begin, run.seconds)
    run.loop.launch(name, lambda process: keyboard_user(process, fingers), run.loop.hosts["operator"])
    told = f"somebody types at a {name}"
    is_alone = chance.random() < _ALONE and run.claims("joystick")
    if is_alone:
        run.loop.terminate("joystick")
        told += ", and the joystick has ended"
    yield told
    run.loop.kill(name)
    if is_alone:
        run.loop.start("joystick")
    if fingers.stops:
        run.release_later()
