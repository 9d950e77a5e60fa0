"""Faults of cables, boards and sensors, of the battery, and what people and furniture do."""

from __future__ import annotations

import math
from functools import partial
from random import Random
from typing import Final

from giraff_schemas.services import SERVICES
from giraff_schemas.wire import BoardKind, ResetCause
from giraff_sim.bodies.wheels.body import WheelsBody
from giraff_sim.dst.drill import Course, Drill, Kind, fault
from giraff_sim.dst.judging.ledger import BASE
from giraff_sim.dst.judging.sensors import looks_along
from giraff_sim.dst.judging.stops import BEYOND_US, ROBOT_US
from giraff_sim.world.bno055 import Bno055Fault
from giraff_sim.world.body import Way
from giraff_sim.world.sonar import SonarFault

KINDS: Final[list[Kind]] = []
OF_BUMPERS: Final[list[Kind]] = []
"""Apart, since no seed of the stock robot, which has no bumper, can be asked to reach them."""

SERVED: Final = {kind: service.name for kind in BoardKind for service in SERVICES if service.board is kind}
_CUTOFF_US: Final = 5_500_000  # 5 s of reports below the cut-off, and a stop
_BELOW_VOLTS: Final = 1.0  # under a limit of the battery
_CHARGED_US: Final = 5_500_000  # within which base takes a charged battery for one
_BODY: Final = 0.3  # m
_STRIDE_US: Final = 50_000
_LEGS: Final = 0.15  # m, of a person
_KEEPS_OFF: Final = 0.35  # m from the body


def _bound(kind: BoardKind) -> tuple[int, Way]:
    if kind is BoardKind.RANGER:
        return BEYOND_US, "travel"
    return (ROBOT_US, "any") if kind is BoardKind.BASE else (BEYOND_US, "any")


@fault(KINDS, weight=3.0, lasts=(0.05, 4.0))
def full_buffer(drill: Drill, chance: Random) -> Course:
    kind = chance.choice((BoardKind.BASE, BoardKind.BASE, BoardKind.JOYSTICK, BoardKind.RANGER))
    name = SERVED[kind]
    cable = drill.cable(name)
    if not drill.claims(cable):
        return
    way = chance.choice(("to the board", "to the host", "both ways"))
    cable.holds_to_board, cable.holds_to_host = way != "to the host", way != "to the board"
    bound_us, motion = _bound(kind)
    with drill.stops(f"the serial buffers of {name} hold all", bound_us, motion, drill.driven_by(name)):
        yield f"the serial buffers of {name} hold all {way}"
    cable.holds_to_board = cable.holds_to_host = False


@fault(KINDS, weight=3.0, lasts=(0.05, 3.0))
def unplug(drill: Drill, chance: Random) -> Course:
    kind = chance.choice(tuple(SERVED))
    name = SERVED[kind]
    cable = drill.cable(name)
    if not drill.claims(cable):
        return
    cable.unplug()
    bound_us, motion = _bound(kind)
    with drill.stops(f"the cable of {name} is unplugged", bound_us, motion, drill.driven_by(name)):
        yield f"the cable of {name} is unplugged"
    cable.plug()


@fault(KINDS, weight=3.0, lasts=(0.0, 0.6))
def reset(drill: Drill, chance: Random) -> Course:
    kind = chance.choice(tuple(SERVED))
    cause = chance.choice((ResetCause.POWER_ON, ResetCause.WATCHDOG, ResetCause.EXTERNAL))
    drill.loop.simulation.reset(kind, cause)
    drill.judge.on_reset(kind)
    yield f"the {SERVED[kind]} board is reset: {cause.name}"


@fault(KINDS, weight=3.0, lasts=(0.3, 4.0), calm_after=11.0)
def sonar(drill: Drill, chance: Random) -> Course:
    name, pose = chance.choice(tuple(drill.loop.settings.robot.sensors.items()))
    sensor = drill.loop.simulation.world.sonars[pose.index]
    if not drill.claims(sensor):
        return
    sensor.fault = chance.choice((SonarFault.DEAD, SonarFault.STUCK, SonarFault.FROZEN, SonarFault.WILD))
    told = f"{name} is {sensor.fault}"
    way: Way = "forward" if looks_along(pose, 1.0) else "backward"
    silent = sensor.fault in (SonarFault.DEAD, SonarFault.STUCK)
    with drill.stops(told, BEYOND_US, way, lambda: silent):
        yield told
    sensor.fault = SonarFault.NONE


@fault(KINDS, weight=0.0, lasts=(1.0, 15.0), calm_after=11.0)
def deaf(drill: Drill, chance: Random) -> Course:
    """Not drawn among the others, but beside them."""
    names = chance.choice((("front_left",), ("front_right",), ("front_left", "front_right"), ("rear",)))
    sonars = drill.loop.simulation.world.sonars
    sensors = [sonars[drill.loop.settings.robot.sensors[name].index] for name in names]
    if not drill.claims(*sensors):
        return
    for sensor in sensors:
        sensor.fault = SonarFault.DEAF
    yield f"{' and '.join(names)} hear nothing" if len(names) > 1 else f"{names[0]} hears nothing"
    for sensor in sensors:
        sensor.fault = SonarFault.NONE


@fault(OF_BUMPERS, weight=0.0, lasts=(0.3, 6.0), calm_after=11.0)
def bumper(drill: Drill, chance: Random) -> Course:
    """Not drawn among the others, but beside them."""
    mounted = drill.loop.settings.robot.bumpers
    if not mounted:
        return
    name, mount = chance.choice(tuple(mounted.items()))
    switch = drill.loop.simulation.world.bumpers[mount.index]
    if not drill.claims(switch):
        return
    switch.is_cut = True
    told = f"the wire of the bumper {name} is cut"
    with drill.stops(told, BEYOND_US, mount.way):
        yield told
    switch.is_cut = False


@fault(KINDS, weight=2.0, lasts=(0.2, 3.0))
def tilt_sensor(drill: Drill, chance: Random) -> Course:
    sensor = drill.loop.simulation.bno055
    if sensor is None or not drill.claims(sensor):
        return
    sensor.fault = chance.choice(tuple(fault for fault in Bno055Fault if fault is not Bno055Fault.NONE))
    told = f"the tilt sensor is {sensor.fault.replace('_', ' ')}"
    only_at_start = sensor.fault in (Bno055Fault.WRONG_CHIP, Bno055Fault.SELF_TEST)
    drives = drill.driven_by("joystick")
    with drill.stops(told, BEYOND_US, "any", lambda: not only_at_start and drives()):
        yield told
    sensor.fault = Bno055Fault.NONE


@fault(KINDS, weight=1.0, lasts=(0.5, 3.0))
def encoder(drill: Drill, chance: Random) -> Course:
    wheel = chance.randrange(2)
    body = drill.loop.simulation.world.body
    if not isinstance(body, WheelsBody) or not drill.claims(f"encoder {wheel}"):
        return
    body.cut_encoder(wheel, is_cut=True)
    yield f"the wires of the {('left', 'right')[wheel]} encoder are cut"
    body.cut_encoder(wheel, is_cut=False)
    drill.release_later()


@fault(KINDS, weight=0.0, lasts=(1.0, 15.0))
def flicker(drill: Drill, chance: Random) -> Course:
    """Not drawn among the others, but beside them."""
    wheels = chance.choice(((0,), (1,), (0, 1)))
    body = drill.loop.simulation.world.body
    if not isinstance(body, WheelsBody):
        return
    for wheel in wheels:
        body.flicker_encoder(wheel, flickers=True)
    yield f"the encoder of {' and '.join(('left', 'right')[wheel] for wheel in wheels)} flickers at rest"
    for wheel in wheels:
        body.flicker_encoder(wheel, flickers=False)


@fault(KINDS, weight=0.0, lasts=(2.0, 15.0))
def slipping_encoder(drill: Drill, chance: Random) -> Course:
    """Not drawn among the others, but beside them: one encoder loses counts, or both."""
    wheels, share = chance.choice(((0,), (1,), (0, 1))), chance.uniform(0.2, 0.6)
    body = drill.loop.simulation.world.body
    if not isinstance(body, WheelsBody) or not drill.claims(*(f"encoder {wheel}" for wheel in wheels)):
        return
    for wheel in wheels:
        body.slip_encoder(wheel, share)
    sides = " and ".join(("left", "right")[wheel] for wheel in wheels)
    yield f"{share:.0%} of the counts of the {sides} encoder are lost"
    for wheel in wheels:
        body.slip_encoder(wheel, 0.0)


@fault(KINDS, weight=3.0, lasts=(0.2, 4.0))
def emergency_stop(drill: Drill, chance: Random) -> Course:
    del chance
    if not drill.claims(drill.button):
        return
    drill.button.engage()
    yield "somebody engages the emergency stop"
    drill.button.reset()


@fault(KINDS, weight=1.5, lasts=(0.2, 2.0))
def two_at_the_emergency_stop(drill: Drill, chance: Random) -> Course:
    """Half of the time who engages anew has engaged before: the same latch, which a reset of before leaves, too."""
    if not drill.claims(drill.button):
        return
    drill.button.engage()
    yield "somebody engages the emergency stop, and will reset it while another engages it anew"
    resets_first, _ = chance.sample((True, False), 2)
    later_us = chance.choice((0, 4_000, 12_000))
    by = chance.choice(("", drill.button.instance))
    if by:
        drill.story.log("it is no other, but the same")
        drill.story.count("the same engages the emergency stop anew")
    engage = partial(drill.caretaker.engage, by)
    first, second = (drill.button.reset, engage) if resets_first else (engage, drill.button.reset)
    first()
    drill.loop.agenda.at(drill.loop.agenda.now_us + later_us, second)
    drill.release_later()


@fault(KINDS, weight=1.0, lasts=(2.0, 8.0), calm_after=7.0)
def battery(drill: Drill, chance: Random) -> Course:
    plant = drill.loop.simulation.world.plant
    if not drill.claims(plant):
        return
    before, limits = plant.open_volts, drill.loop.settings.base
    limit = chance.choice((limits.battery_cutoff, limits.battery_low))
    plant.open_volts = limit - _BELOW_VOLTS
    told = f"the battery falls to {plant.open_volts:g} V"
    flat = limit == limits.battery_cutoff
    before_us = dict(drill.judge.reported_us)

    def is_known() -> bool:
        base = drill.loop.processes.get(BASE)
        return base is not None and drill.judge.reported_us[base] - before_us.get(base, 0) > _CUTOFF_US

    with drill.stops(told, _CUTOFF_US, "any", lambda: flat and is_known()):
        yield told
    plant.open_volts = before
    drill.release_later(_CHARGED_US)


@fault(KINDS, weight=3.0, lasts=(0.5, 6.0), calm_after=11.0)
def obstacle(drill: Drill, chance: Random) -> Course:
    world = drill.loop.simulation.world
    pose = world.plant.pose
    towards = pose.yaw + chance.choice((0.0, 0.0, math.pi)) + chance.uniform(-0.4, 0.4)
    distance, half = _BODY + chance.uniform(0.05, 1.5), chance.uniform(0.05, 0.5)
    x, y = pose.x + distance * math.cos(towards), pose.y + distance * math.sin(towards)
    across = towards + math.pi / 2.0 + chance.uniform(-0.4, 0.4)
    dx, dy = half * math.cos(across), half * math.sin(across)
    name = drill.fresh_name("obstacle")
    world.room.add_wall(name, [(x - dx, y - dy), (x + dx, y + dy)])
    yield f"something stands {world.room.clearance(pose.x, pose.y) - _BODY:.2f} m from the body"
    world.room.remove(name)


@fault(KINDS, weight=2.0, lasts=(1.0, 6.0), calm_after=11.0)
def person(drill: Drill, chance: Random) -> Course:
    world = drill.loop.simulation.world
    pose = world.plant.pose
    bearing, speed = chance.uniform(-math.pi, math.pi), chance.uniform(0.3, 1.0)
    x, y = pose.x + 1.5 * math.cos(bearing), pose.y + 1.5 * math.sin(bearing)
    goal = bearing + math.pi + chance.uniform(-0.5, 0.5)
    step_x, step_y = (speed * _STRIDE_US * 1e-6 * part for part in (math.cos(goal), math.sin(goal)))
    name = drill.fresh_name("person")
    world.room.add_post(name, x, y, _LEGS)
    is_here = True

    def walk() -> None:
        nonlocal x, y
        if not is_here:
            return
        robot = world.plant.pose
        if math.hypot(x + step_x - robot.x, y + step_y - robot.y) > _BODY + _LEGS + _KEEPS_OFF:
            x, y = x + step_x, y + step_y
            world.room.remove(name)
            world.room.add_post(name, x, y, _LEGS)
        drill.loop.agenda.at(drill.loop.agenda.now_us + _STRIDE_US, walk)

    walk()
    yield f"a person walks by at {speed:.1f} m/s"
    is_here = False
    world.room.remove(name)
