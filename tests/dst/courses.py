"""Faults for staged runs: each does one thing."""

from __future__ import annotations

import math
from collections.abc import Callable
from random import Random
from typing import Final

import msgspec

from giraff_schemas.wire import BoardKind, ResetCause
from giraff_sim.bodies.wheels.body import WheelsBody
from giraff_sim.dst.drill import Begin, Course, Drill
from giraff_sim.dst.hands import Fingers
from giraff_sim.dst.judging.stops import BEYOND_US, ROBOT_US
from giraff_sim.dst.people import typist
from giraff_sim.record import Verdict
from giraff_sim.world.bno055 import Bno055Fault
from giraff_sim.world.sonar import SonarFault
from tests.support.floods import Stranger
from tests.support.wheels import wheels_of

HAND: Final = 5.0
"""m/s² at its rim, of a hand that holds a wheel back: more than the speed control makes good, too little to stop it."""


def kill(name: str) -> Begin:
    """End a service, and start it again."""

    def course(drill: Drill, chance: Random) -> Course:
        del chance
        drill.loop.kill(name)
        with drill.stops(f"{name} is killed", ROBOT_US if name in ("guard", "base") else BEYOND_US):
            yield f"{name} is killed"
        drill.loop.start(name)

    return course


def cut(how: str) -> Begin:
    """Cut the operator's way to the robot."""

    def course(drill: Drill, chance: Random) -> Course:
        del chance
        link = drill.link("operator", "robot")
        link.cut = how
        with drill.stops("the network is cut", BEYOND_US):
            yield "the network is cut"
        drill.network.mend(link)

    return course


def unplug(name: str) -> Begin:
    """Pull a board's cable out, and plug it in again."""

    def course(drill: Drill, chance: Random) -> Course:
        del chance
        drill.cable(name).unplug()
        yield f"{name} is unplugged"
        drill.cable(name).plug()

    return course


def deafen(drill: Drill, chance: Random) -> Course:
    """Have nothing answer the front sensors."""
    del chance
    front = [sonar for index, sonar in drill.loop.simulation.world.sonars.items() if index < 2]
    for sonar in front:
        sonar.fault = SonarFault.DEAF
    yield "the front sensors hear nothing"
    for sonar in front:
        sonar.fault = SonarFault.NONE


def engage_anew(drill: Drill, chance: Random) -> Course:
    """Let who has engaged the emergency stop do so again, and reset it before base can have heard."""
    del chance
    drill.caretaker.engage(drill.button.instance)
    drill.loop.agenda.at(drill.loop.agenda.now_us + 8_000, drill.button.reset)
    yield "the same engages the emergency stop anew"


def hang_disk(drill: Drill, chance: Random) -> Course:
    """Have the robot's disk write nothing."""
    del chance
    disk = drill.loop.hosts["robot"].disk
    disk.hang()
    yield "the robot's disk hangs"
    disk.go_on()


def touch_sensors(drill: Drill, chance: Random) -> Course:
    """Have something stand 8 cm before the front sensors, and go away."""
    del chance
    x, y, yaw = drill.loop.simulation.world.plant.pose
    ahead = max(pose.x for pose in drill.loop.settings.robot.sensors.values()) + 0.08
    ends = [
        (x + ahead * math.cos(yaw) - w * math.sin(yaw), y + ahead * math.sin(yaw) + w * math.cos(yaw))
        for w in (-0.5, 0.5)
    ]
    drill.loop.simulation.world.room.add_wall("box", ends)
    yield "something nearly touches the front sensors"
    drill.loop.simulation.world.room.remove("box")


def reset_board(drill: Drill, chance: Random) -> Course:
    """Reset the base board."""
    del chance
    drill.loop.simulation.reset(BoardKind.BASE, ResetCause.EXTERNAL)
    drill.judge.on_reset(BoardKind.BASE)
    yield "the base board is reset"


def stop(drill: Drill, chance: Random) -> Course:
    """Engage the emergency stop, and reset it."""
    del chance
    drill.button.engage()
    yield "the emergency stop is engaged"
    drill.button.reset()


def engage(drill: Drill, chance: Random) -> Course:
    """Engage the emergency stop for good."""
    del chance
    drill.button.engage()
    yield "the emergency stop is engaged"


def typing(drill: Drill, chance: Random) -> Course:
    """Let somebody type at a keyboard."""
    begin = drill.loop.agenda.now_us * 1e-6
    fingers = Fingers(chance, begin, 100.0)
    drill.loop.launch("keyboard", lambda process: typist(process, fingers), drill.loop.hosts["operator"])
    yield "somebody types"


def flooding(drill: Drill, chance: Random) -> Course:
    """Ten thousand commands a second of an operator who does not drive."""
    del chance
    drill.loop.launch("stranger", Stranger, drill.loop.hosts["operator"])
    yield "a stranger floods the guard"
    drill.loop.kill("stranger")


def typing_a_stop(drill: Drill, chance: Random) -> Course:
    """Let somebody press the space bar of a keyboard, with whatever other keys."""
    begin = drill.loop.agenda.now_us * 1e-6
    typists = (Fingers(chance, begin, begin + 3.0) for _ in range(100))
    fingers = next(each for each in typists if each.stops)
    drill.loop.launch("keyboard", lambda process: typist(process, fingers), drill.loop.hosts["operator"])
    yield "somebody types, the space bar among others"


def replay(*kinds: type[msgspec.Struct], since: float = 0.0, until: float = 1000.0) -> Begin:
    """Carry old messages of these kinds again: all that were said between those two moments, s."""

    def course(drill: Drill, chance: Random) -> Course:
        del chance
        old = [
            said
            for said in drill.network.history
            if isinstance(said.body, kinds) and since * 1e6 <= said.at_us <= until * 1e6
        ]
        assert old, "there is nothing to replay"
        drill.network.replay(old, 20_000)
        yield f"{len(old)} old samples come again"

    return course


def watch(verdicts: list[Verdict]) -> Begin:
    """Take the record of the motors from the beginning to the end of this fault."""

    def course(drill: Drill, chance: Random) -> Course:
        del chance
        since_us = drill.loop.agenda.now_us
        yield "the motors are watched"
        verdicts.append(drill.loop.simulation.record.verdict(since_us, drill.loop.agenda.now_us))

    return course


def hold_frames(drill: Drill, chance: Random) -> Course:
    """Let the serial buffers keep what base sends, and hand it over at the end."""
    del chance
    cable = drill.cable("base")
    cable.holds_to_board = True
    with drill.stops("the serial buffers hold all", ROBOT_US):
        yield "the serial buffers hold all"
    cable.holds_to_board = False


def end(name: str) -> Begin:
    """End a service in order, and start it again."""

    def course(drill: Drill, chance: Random) -> Course:
        del chance
        drill.loop.terminate(name)
        yield f"{name} is terminated"
        drill.loop.start(name)

    return course


def pause(name: str) -> Begin:
    """Suspend a service, and let it go on."""

    def course(drill: Drill, chance: Random) -> Course:
        del chance
        process = drill.loop.processes[name]
        process.paused = True
        yield f"{name} is paused"
        process.paused = False
        process.go_on(0)

    return course


def cut_both_ways(drill: Drill, chance: Random) -> Course:
    """Cut the network; TCP holds what is said."""
    del chance
    links = drill.link("operator", "robot"), drill.link("robot", "operator")
    for link in links:
        link.cut = "holds"
    yield "the network is cut both ways"
    for link in links:
        drill.network.mend(link)


def delay(seconds: float) -> Begin:
    """Let the network take so long, both ways."""

    def course(drill: Drill, chance: Random) -> Course:
        del chance
        links = drill.link("operator", "robot"), drill.link("robot", "operator")
        for link in links:
            link.delay_us = round(seconds * 1e6)
        yield f"the network takes {seconds:g} s"
        for link in links:
            link.delay_us = 0

    return course


def reset_of(kind: BoardKind, cause: ResetCause) -> Begin:
    """Reset a board."""

    def course(drill: Drill, chance: Random) -> Course:
        del chance
        drill.loop.simulation.reset(kind, cause)
        drill.judge.on_reset(kind)
        yield f"the {kind.name} board is reset: {cause.name}"

    return course


def fail_sonar(index: int, fault: SonarFault) -> Begin:
    """Let a sonar fail."""

    def course(drill: Drill, chance: Random) -> Course:
        del chance
        sensor = drill.loop.simulation.world.sonars[index]
        sensor.fault = fault
        yield f"sonar {index} is {fault}"
        sensor.fault = SonarFault.NONE

    return course


def fail_tilt_sensor(fault: Bno055Fault) -> Begin:
    """Let the tilt sensor fail."""

    def course(drill: Drill, chance: Random) -> Course:
        del chance
        sensor = drill.loop.simulation.bno055
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

    def course(drill: Drill, chance: Random) -> Course:
        del chance
        body = wheels_of(drill.loop.simulation.world)
        do(body, True)
        yield told
        do(body, False)

    return course


def discharge(volts: float) -> Begin:
    """Let the battery fall."""

    def course(drill: Drill, chance: Random) -> Course:
        del chance
        plant = drill.loop.simulation.world.plant
        before, plant.open_volts = plant.open_volts, volts
        yield f"the battery falls to {volts:g} V"
        plant.open_volts = before

    return course
