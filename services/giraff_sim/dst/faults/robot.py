"""Faults of cables, boards and sensors, of the battery, and what people and furniture do."""

import math
from functools import partial
from random import Random
from typing import Final

from giraff_core.senses import Bumper, Ultrasonic
from giraff_schemas.services import SERVICES
from giraff_schemas.wire import BoardKind, ResetCause
from giraff_sim.bodies.wheels.body import WheelsBody
from giraff_sim.dst.judging.ledger import BASE
from giraff_sim.dst.judging.sensors import looks_along
from giraff_sim.dst.judging.stops import BEYOND_US, ROBOT_US
from giraff_sim.dst.simulated_run import Begin, Course, Kind, SimulatedRun, fault
from giraff_sim.world.bno055 import Bno055Fault
from giraff_sim.world.body import BoundedMotion
from giraff_sim.world.sonar import SonarFault

KINDS: Final[list[Kind]] = []
OF_BUMPERS: Final[list[Kind]] = []
"""Apart, since no seed of the stock robot, which has no bumper, can be asked to reach them."""
OF_CONTROLLERS: Final[list[Kind]] = []
"""Apart for the same reason: a stock robot's board is no process in front of a motor controller."""

SERVED: Final = {kind: service.name for kind in BoardKind for service in SERVICES if service.board is kind}
_CUTOFF_US: Final = 5_500_000  # 5 s of reports below the cut-off, and a stop
_BELOW_VOLTS: Final = 1.0  # under a limit of the battery
_CHARGED_US: Final = 5_500_000  # within which base takes a charged battery for one
_BODY: Final = 0.3  # m
_STRIDE_US: Final = 50_000
_DEAD_VOLTS: Final = 4.0  # of a battery at which a motor controller is off
_LEGS: Final = 0.15  # m, of a person
_KEEPS_OFF: Final = 0.35  # m from the body


def _bound(kind: BoardKind) -> tuple[int, BoundedMotion]:
    if kind is BoardKind.RANGER:
        return BEYOND_US, "travel"
    return (ROBOT_US, "any") if kind is BoardKind.BASE else (BEYOND_US, "any")


@fault(KINDS, weight=3.0, lasts=(0.05, 4.0))
def full_buffer(run: SimulatedRun, chance: Random) -> Course:
    kind = chance.choice((BoardKind.BASE, BoardKind.BASE, BoardKind.JOYSTICK, BoardKind.RANGER))
    name = SERVED[kind]
    cable = run.cable(name)
    if not run.claims(cable):
        return
    way = chance.choice(("to the board", "to the host", "both ways"))
    cable.holds_to_board, cable.holds_to_host = way != "to the host", way != "to the board"
    bound_us, motion = _bound(kind)
    with run.stops(f"the serial buffers of {name} hold all", bound_us, motion, run.driven_by(name)):
        yield f"the serial buffers of {name} hold all {way}"
    cable.holds_to_board = cable.holds_to_host = False


@fault(KINDS, weight=3.0, lasts=(0.05, 3.0))
def unplug(run: SimulatedRun, chance: Random) -> Course:
    kind = chance.choice(tuple(SERVED))
    name = SERVED[kind]
    cable = run.cable(name)
    if not run.claims(cable):
        return
    cable.unplug()
    bound_us, motion = _bound(kind)
    with run.stops(f"the cable of {name} is unplugged", bound_us, motion, run.driven_by(name)):
        yield f"the cable of {name} is unplugged"
    cable.plug()


@fault(KINDS, weight=3.0, lasts=(0.0, 0.6))
def reset(run: SimulatedRun, chance: Random) -> Course:
    kind = chance.choice(tuple(SERVED))
    cause = chance.choice((ResetCause.POWER_ON, ResetCause.WATCHDOG, ResetCause.EXTERNAL))
    run.loop.simulation.reset(kind, cause)
    run.judge.on_reset(kind)
    yield f"the {SERVED[kind]} board is reset: {cause.name}"


@fault(KINDS, weight=3.0, lasts=(0.3, 4.0), calm_after=11.0)
def sonar(run: SimulatedRun, chance: Random) -> Course:
    name, pose = chance.choice(tuple(run.loop.settings.robot.of(Ultrasonic).items()))
    sensor = run.loop.simulation.world.sonars[pose.index]
    if not run.claims(sensor):
        return
    sensor.fault = chance.choice((SonarFault.DEAD, SonarFault.STUCK, SonarFault.FROZEN, SonarFault.WILD))
    told = f"{name} is {sensor.fault}"
    way: BoundedMotion = "forward" if looks_along(pose, 1.0) else "backward"
    silent = sensor.fault in (SonarFault.DEAD, SonarFault.STUCK)
    with run.stops(told, BEYOND_US, way, lambda: silent):
        yield told
    sensor.fault = SonarFault.NONE


@fault(KINDS, weight=0.0, lasts=(1.0, 15.0), calm_after=11.0)
def deaf(run: SimulatedRun, chance: Random) -> Course:
    """Not drawn among the others, but beside them."""
    names = chance.choice((("front_left",), ("front_right",), ("front_left", "front_right"), ("rear",)))
    sonars, mounts = run.loop.simulation.world.sonars, run.loop.settings.robot.of(Ultrasonic)
    sensors = [sonars[mounts[name].index] for name in names]
    if not run.claims(*sensors):
        return
    for sensor in sensors:
        sensor.fault = SonarFault.DEAF
    yield f"{' and '.join(names)} hear nothing" if len(names) > 1 else f"{names[0]} hears nothing"
    for sensor in sensors:
        sensor.fault = SonarFault.NONE


@fault(OF_BUMPERS, weight=0.0, lasts=(0.3, 6.0), calm_after=11.0)
def bumper(run: SimulatedRun, chance: Random) -> Course:
    """Not drawn among the others, but beside them."""
    mounted = run.loop.settings.robot.of(Bumper)
    if not mounted:
        return
    name, mount = chance.choice(tuple(mounted.items()))
    switch = run.loop.simulation.world.bumpers[mount.index]
    if not run.claims(switch):
        return
    switch.is_cut = True
    told = f"the wire of the bumper {name} is cut"
    with run.stops(told, BEYOND_US, mount.way):
        yield told
    switch.is_cut = False


_GIVES_ON_US: Final = 12_000  # of an adapter: what it held may begin with a command that drives, ahead of stops
_KILLED: Final = "the base board's process is killed"
CONTROLLER_FAULTS: Final = {
    _KILLED: ("process_stalls", 1),
    "the base board's process is suspended": ("process_stalls", 1),
    "the base board's process hangs": ("process_stalls", 2),
    "the line to the motor controller is cut": ("driver_line_cut", 1),
    "an adapter holds up the line to the motor controller": ("driver_line_held", 1),
    "the motor controller's emergency input is pressed": ("cord_pulled", 1),
    "the motor controller has no power": ("", 0),
}
"""Field of the board's model that each sets, and its value."""


def controller_fault(what: str) -> Begin:
    """Make one of `CONTROLLER_FAULTS` happen. It leaves a board that is no process as it is."""

    def course(run: SimulatedRun, chance: Random) -> Course:
        del chance
        simulation, (field, value) = run.loop.simulation, CONTROLLER_FAULTS[what]
        plant, model = simulation.world.plant, simulation.boards[BoardKind.BASE].model
        board = simulation.world.body.board
        if not board.is_process or not run.claims(CONTROLLER_FAULTS, plant):
            return
        volts = plant.open_volts
        if field:
            setattr(model, field, value)
        else:
            plant.open_volts = _DEAD_VOLTS
        # A process that hangs is reset by its watchdog, and may be armed anew.
        bound_us = max(ROBOT_US, round(board.stops_after_s * 1e6))
        with run.stops(what, bound_us, "any", lambda: not field or getattr(model, field) == value):
            yield what
        plant.open_volts = volts
        if field:
            setattr(model, field, 0)
        if field == "driver_line_held":
            run.judge.excuse(_GIVES_ON_US)
        if what == _KILLED:
            simulation.reset(BoardKind.BASE, ResetCause.POWER_ON)
        run.release_later()

    return course


@fault(OF_CONTROLLERS, weight=0.0, lasts=(0.02, 3.0), calm_after=4.0)
def controller(run: SimulatedRun, chance: Random) -> Course:
    """Not drawn among the others, but beside them."""
    yield from controller_fault(chance.choice(tuple(CONTROLLER_FAULTS)))(run, chance)


@fault(KINDS, weight=2.0, lasts=(0.2, 3.0))
def tilt_sensor(run: SimulatedRun, chance: Random) -> Course:
    sensor = run.loop.simulation.bno055
    if sensor is None or not run.claims(sensor):
        return
    sensor.fault = chance.choice(tuple(fault for fault in Bno055Fault if fault is not Bno055Fault.NONE))
    told = f"the tilt sensor is {sensor.fault.replace('_', ' ')}"
    only_at_start = sensor.fault in (Bno055Fault.WRONG_CHIP, Bno055Fault.SELF_TEST)
    drives = run.driven_by("joystick")
    with run.stops(told, BEYOND_US, "any", lambda: not only_at_start and drives()):
        yield told
    sensor.fault = Bno055Fault.NONE


@fault(KINDS, weight=1.0, lasts=(0.5, 3.0))
def encoder(run: SimulatedRun, chance: Random) -> Course:
    wheel = chance.randrange(2)
    body = run.loop.simulation.world.body
    if not isinstance(body, WheelsBody) or not run.claims(f"encoder {wheel}"):
        return
    body.cut_encoder(wheel, is_cut=True)
    yield f"the wires of the {('left', 'right')[wheel]} encoder are cut"
    body.cut_encoder(wheel, is_cut=False)
    run.release_later()


@fault(KINDS, weight=0.0, lasts=(1.0, 15.0))
def flicker(run: SimulatedRun, chance: Random) -> Course:
    """Not drawn among the others, but beside them."""
    wheels = chance.choice(((0,), (1,), (0, 1)))
    body = run.loop.simulation.world.body
    if not isinstance(body, WheelsBody):
        return
    for wheel in wheels:
        body.flicker_encoder(wheel, flickers=True)
    yield f"the encoder of {' and '.join(('left', 'right')[wheel] for wheel in wheels)} flickers at rest"
    for wheel in wheels:
        body.flicker_encoder(wheel, flickers=False)


@fault(KINDS, weight=0.0, lasts=(2.0, 15.0))
def slipping_encoder(run: SimulatedRun, chance: Random) -> Course:
    """Not drawn among the others, but beside them: one encoder loses counts, or both."""
    wheels, share = chance.choice(((0,), (1,), (0, 1))), chance.uniform(0.2, 0.6)
    body = run.loop.simulation.world.body
    if not isinstance(body, WheelsBody) or not run.claims(*(f"encoder {wheel}" for wheel in wheels)):
        return
    for wheel in wheels:
        body.slip_encoder(wheel, share)
    sides = " and ".join(("left", "right")[wheel] for wheel in wheels)
    yield f"{share:.0%} of the counts of the {sides} encoder are lost"
    for wheel in wheels:
        body.slip_encoder(wheel, 0.0)


@fault(KINDS, weight=3.0, lasts=(0.2, 4.0))
def emergency_stop(run: SimulatedRun, chance: Random) -> Course:
    del chance
    if not run.claims(run.button):
        return
    run.button.engage()
    yield "somebody engages the emergency stop"
    run.button.reset()


@fault(KINDS, weight=1.5, lasts=(0.2, 2.0))
def two_at_the_emergency_stop(run: SimulatedRun, chance: Random) -> Course:
    """Half of the time who engages anew has engaged before: the same latch, which a reset of before leaves, too."""
    if not run.claims(run.button):
        return
    run.button.engage()
    yield "somebody engages the emergency stop, and will reset it while another engages it anew"
    resets_first, _ = chance.sample((True, False), 2)
    later_us = chance.choice((0, 4_000, 12_000))
    by = chance.choice(("", run.button.instance))
    if by:
        run.event_log.log("it is no other, but the same")
        run.event_log.count("the same engages the emergency stop anew")
    engage = partial(run.estop_operator.engage, by)
    first, second = (run.button.reset, engage) if resets_first else (engage, run.button.reset)
    first()
    run.loop.agenda.at(run.loop.agenda.now_us + later_us, second)
    run.release_later()


@fault(KINDS, weight=1.0, lasts=(2.0, 8.0), calm_after=7.0)
def battery(run: SimulatedRun, chance: Random) -> Course:
    plant = run.loop.simulation.world.plant
    if not run.claims(plant):
        return
    before, limits = plant.open_volts, run.loop.settings.base
    limit = chance.choice((limits.battery_cutoff, limits.battery_low))
    plant.open_volts = limit - _BELOW_VOLTS
    told = f"the battery falls to {plant.open_volts:g} V"
    flat = limit == limits.battery_cutoff
    before_us = dict(run.judge.reported_us)

    def is_known() -> bool:
        base = run.loop.processes.get(BASE)
        return base is not None and run.judge.reported_us[base] - before_us.get(base, 0) > _CUTOFF_US

    with run.stops(told, _CUTOFF_US, "any", lambda: flat and is_known()):
        yield told
    plant.open_volts = before
    run.release_later(_CHARGED_US)


@fault(KINDS, weight=3.0, lasts=(0.5, 6.0), calm_after=11.0)
def obstacle(run: SimulatedRun, chance: Random) -> Course:
    world = run.loop.simulation.world
    pose = world.plant.pose
    towards = pose.yaw + chance.choice((0.0, 0.0, math.pi)) + chance.uniform(-0.4, 0.4)
    distance, half = _BODY + chance.uniform(0.05, 1.5), chance.uniform(0.05, 0.5)
    x, y = pose.x + distance * math.cos(towards), pose.y + distance * math.sin(towards)
    across = towards + math.pi / 2.0 + chance.uniform(-0.4, 0.4)
    dx, dy = half * math.cos(across), half * math.sin(across)
    name = run.fresh_name("obstacle")
    world.room.add_wall(name, [(x - dx, y - dy), (x + dx, y + dy)])
    yield f"something stands {world.room.clearance(pose.x, pose.y) - _BODY:.2f} m from the body"
    world.room.remove(name)


@fault(KINDS, weight=2.0, lasts=(1.0, 6.0), calm_after=11.0)
def person(run: SimulatedRun, chance: Random) -> Course:
    world = run.loop.simulation.world
    pose = world.plant.pose
    bearing, speed = chance.uniform(-math.pi, math.pi), chance.uniform(0.3, 1.0)
    x, y = pose.x + 1.5 * math.cos(bearing), pose.y + 1.5 * math.sin(bearing)
    goal = bearing + math.pi + chance.uniform(-0.5, 0.5)
    step_x, step_y = (speed * _STRIDE_US * 1e-6 * part for part in (math.cos(goal), math.sin(goal)))
    name = run.fresh_name("person")
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
        run.loop.agenda.at(run.loop.agenda.now_us + _STRIDE_US, walk)

    walk()
    yield f"a person walks by at {speed:.1f} m/s"
    is_here = False
    world.room.remove(name)
