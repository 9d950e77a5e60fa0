"""Faults for staged runs: each does one thing."""

import math
from collections.abc import Callable
from random import Random
from typing import Final

import msgspec

from giraff_core.senses import Ultrasonic
from giraff_schemas.wire import BoardKind, ResetCause
from giraff_sim.bodies.wheels.body import WheelsBody
from giraff_sim.dst.hands import Fingers
from giraff_sim.dst.judging.stops import BEYOND_US, ROBOT_US
from giraff_sim.dst.people import keyboard_user
from giraff_sim.dst.simulated_run import Begin, Course, SimulatedRun
from giraff_sim.record import MotorWindow
from giraff_sim.world.bno055 import Bno055Fault
from giraff_sim.world.sonar import SonarFault
from tests.support.floods import Stranger
from tests.support.wheels import wheels_of

HAND: Final = 5.0
"""m/s² at its rim, of a hand that holds a wheel back: more than the speed control makes good, too little to stop it."""


def kill(name: str) -> Begin:
    """End a service, and start it again."""

    def course(run: SimulatedRun, chance: Random) -> Course:
        del chance
        run.loop.kill(name)
        with run.stops(f"{name} is killed", ROBOT_US if name in ("guard", "base") else BEYOND_US):
            yield f"{name} is killed"
        run.loop.start(name)

    return course


def cut(how: str) -> Begin:
    """Cut the operator's way to the robot."""

    def course(run: SimulatedRun, chance: Random) -> Course:
        del chance
        link = run.link("operator", "robot")
        link.cut = how
        with run.stops("the network is cut", BEYOND_US):
            yield "the network is cut"
        run.network.mend(link)

    return course


def unplug(name: str) -> Begin:
    """Pull a board's cable out, and plug it in again."""

    def course(run: SimulatedRun, chance: Random) -> Course:
        del chance
        run.cable(name).unplug()
        yield f"{name} is unplugged"
        run.cable(name).plug()

    return course


def deafen(run: SimulatedRun, chance: Random) -> Course:
    """Have nothing answer the front sensors."""
    del chance
    front = [sonar for index, sonar in run.loop.simulation.world.sonars.items() if index < 2]
    for sonar in front:
        sonar.fault = SonarFault.DEAF
    yield "the front sensors hear nothing"
    for sonar in front:
        sonar.fault = SonarFault.NONE


def engage_anew(run: SimulatedRun, chance: Random) -> Course:
    """Let who has engaged the emergency stop do so again, and reset it before base can have heard."""
    del chance
    run.estop_operator.engage(run.button.instance)
    run.loop.agenda.at(run.loop.agenda.now_us + 8_000, run.button.reset)
    yield "the same engages the emergency stop anew"


def hang_disk(run: SimulatedRun, chance: Random) -> Course:
    """Have the robot's disk write nothing."""
    del chance
    disk = run.loop.hosts["robot"].disk
    disk.hang()
    yield "the robot's disk hangs"
    disk.go_on()


def touch_sensors(run: SimulatedRun, chance: Random) -> Course:
    """Have something stand 8 cm before the front sensors, and go away."""
    del chance
    x, y, yaw = run.loop.simulation.world.plant.pose
    ahead = max(pose.x for pose in run.loop.settings.robot.of(Ultrasonic).values()) + 0.08
    ends = [
        (x + ahead * math.cos(yaw) - w * math.sin(yaw), y + ahead * math.sin(yaw) + w * math.cos(yaw))
        for w in (-0.5, 0.5)
    ]
    run.loop.simulation.world.room.add_wall("box", ends)
    yield "something nearly touches the front sensors"
    run.loop.simulation.world.room.remove("box")


def reset_board(run: SimulatedRun, chance: Random) -> Course:
    """Reset the base board."""
    del chance
    run.loop.simulation.reset(BoardKind.BASE, ResetCause.EXTERNAL)
    run.judge.on_reset(BoardKind.BASE)
    yield "the base board is reset"


def stop(run: SimulatedRun, chance: Random) -> Course:
    """Engage the emergency stop, and reset it."""
    del chance
    run.button.engage()
    yield "the emergency stop is engaged"
    run.button.reset()


def engage(run: SimulatedRun, chance: Random) -> Course:
    """Engage the emergency stop for good."""
    del chance
    run.button.engage()
    yield "the emergency stop is engaged"


def typing(run: SimulatedRun, chance: Random) -> Course:
    """Let somebody type at a keyboard."""
    begin = run.loop.agenda.now_us * 1e-6
    fingers = Fingers(chance, begin, 100.0)
    run.loop.launch("keyboard", lambda process: keyboard_user(process, fingers), run.loop.hosts["operator"])
    yield "somebody types"


def flooding(run: SimulatedRun, chance: Random) -> Course:
    """Ten thousand commands a second of an operator who does not drive."""
    del chance
    run.loop.launch("stranger", Stranger, run.loop.hosts["operator"])
    yield "a stranger floods the guard"
    run.loop.kill("stranger")


def typing_a_stop(run: SimulatedRun, chance: Random) -> Course:
    """Let somebody press the space bar of a keyboard, with whatever other keys."""
    begin = run.loop.agenda.now_us * 1e-6
    users = (Fingers(chance, begin, begin + 3.0) for _ in range(100))
    fingers = next(each for each in users if each.stops)
    run.loop.launch("keyboard", lambda process: keyboard_user(process, fingers), run.loop.hosts["operator"])
    yield "somebody types, the space bar among others"


def replay(*kinds: type[msgspec.Struct], since: float = 0.0, until: float = 1000.0) -> Begin:
    """Carry old messages of these kinds again: all that were said between those two moments, s."""

    def course(run: SimulatedRun, chance: Random) -> Course:
        del chance
        old = [
            said
            for said in run.network.history
            if isinstance(said.body, kinds) and since * 1e6 <= said.at_us <= until * 1e6
        ]
        assert old, "there is nothing to replay"
        run.network.replay(old, 20_000)
        yield f"{len(old)} old samples come again"

    return course


def watch(verdicts: list[MotorWindow]) -> Begin:
    """Take the record of the motors from the beginning to the end of this fault."""

    def course(run: SimulatedRun, chance: Random) -> Course:
        del chance
        since_us = run.loop.agenda.now_us
        yield "the motors are watched"
        verdicts.append(run.loop.simulation.record.window(since_us, run.loop.agenda.now_us))

    return course


def hold_frames(run: SimulatedRun, chance: Random) -> Course:
    """Let the serial buffers keep what base sends, and hand it over at the end."""
    del chance
    cable = run.cable("base")
    cable.holds_to_board = True
    with run.stops("the serial buffers hold all", ROBOT_US):
        yield "the serial buffers hold all"
    cable.holds_to_board = False


def end(name: str) -> Begin:
    """End a service in order, and start it again."""

    def course(run: SimulatedRun, chance: Random) -> Course:
        del chance
        run.loop.terminate(name)
        yield f"{name} is terminated"
        run.loop.start(name)

    return course


def pause(name: str) -> Begin:
    """Suspend a service, and let it go on."""

    def course(run: SimulatedRun, chance: Random) -> Course:
        del chance
        process = run.loop.processes[name]
        process.paused = True
        yield f"{name} is paused"
        process.paused = False
        process.go_on(0)

    return course


def cut_both_ways(run: SimulatedRun, chance: Random) -> Course:
    """Cut the network; TCP holds what is said."""
    del chance
    links = run.link("operator", "robot"), run.link("robot", "operator")
    for link in links:
        link.cut = "holds"
    yield "the network is cut both ways"
    for link in links:
        run.network.mend(link)


def delay(seconds: float) -> Begin:
    """Let the network take so long, both ways."""

    def course(run: SimulatedRun, chance: Random) -> Course:
        del chance
        links = run.link("operator", "robot"), run.link("robot", "operator")
        for link in links:
            link.delay_us = round(seconds * 1e6)
        yield f"the network takes {seconds:g} s"
        for link in links:
            link.delay_us = 0

    return course


def reset_of(kind: BoardKind, cause: ResetCause) -> Begin:
    """Reset a board."""

    def course(run: SimulatedRun, chance: Random) -> Course:
        del chance
        run.loop.simulation.reset(kind, cause)
        run.judge.on_reset(kind)
        yield f"the {kind.name} board is reset: {cause.name}"

    return course


def fail_sonar(index: int, fault: SonarFault) -> Begin:
    """Let a sonar fail."""

    def course(run: SimulatedRun, chance: Random) -> Course:
        del chance
        sensor = run.loop.simulation.world.sonars[index]
        sensor.fault = fault
        yield f"sonar {index} is {fault}"
        sensor.fault = SonarFault.NONE

    return course


def fail_tilt_sensor(fault: Bno055Fault) -> Begin:
    """Let the tilt sensor fail."""

    def course(run: SimulatedRun, chance: Random) -> Course:
        del chance
        sensor = run.loop.simulation.bno055
        assert sensor is not None
        sensor.fault = fault
        yield f"the tilt sensor is {fault}"
        sensor.fault = Bno055Fault.NONE

    return course


def cut_encoder(wheel: int) -> Begin:
    """Cut the wires of an encoder."""
    return _on_a_wheel(f"encoder {wheel} is cut", lambda body, cut: body.cut_encoder(wheel, is_cut=cut))


def cut_signal(*wheels: int) -> Begin:
    """Pull off the wires from servo outputs to the motor driver."""

    def do(body: WheelsBody, is_cut: bool) -> None:
        for wheel in wheels:
            body.cut_signal(wheel, is_cut=is_cut)

    return _on_a_wheel(f"signal wires {wheels} are cut", do)


def block_wheel(wheel: int) -> Begin:
    """Hold a wheel so that it does not turn."""
    return _on_a_wheel(f"wheel {wheel} is blocked", lambda body, held: body.block_wheel(wheel, is_blocked=held))


def brake_wheel(wheel: int, brake: float) -> Begin:
    """Hold a wheel back by so many m/s², as a hand does."""
    return _on_a_wheel(f"wheel {wheel} is held back", lambda body, held: body.brake_wheel(wheel, brake * held))


def _on_a_wheel(told: str, do: Callable[[WheelsBody, bool], None]) -> Begin:
    """Have `do` begin something, and end it: True, then False."""

    def course(run: SimulatedRun, chance: Random) -> Course:
        del chance
        body = wheels_of(run.loop.simulation.world)
        do(body, True)
        yield told
        do(body, False)

    return course


def discharge(volts: float) -> Begin:
    """Let the battery fall."""

    def course(run: SimulatedRun, chance: Random) -> Course:
        del chance
        plant = run.loop.simulation.world.plant
        before, plant.open_volts = plant.open_volts, volts
        yield f"the battery falls to {volts:g} V"
        plant.open_volts = before

    return course
