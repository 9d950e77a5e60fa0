"""Ultrasonic sensors by a wall, in simulated time: the services' own motions and pings, judged by the drawn truth."""

import math
from collections import Counter
from collections.abc import Sequence
from typing import Any, Final

import msgspec
import pytest

from giraff_core.io import Inbox, Service
from giraff_core.kinematics.pose import Pose
from giraff_core.motion.result import MotionResult, result_of
from giraff_core.senses import Ultrasonic
from giraff_schemas.motion import MotionGo, Step
from giraff_schemas.topics import LEASE, ODOM, RANGE
from giraff_setup.ultrasonic.fit import Echo
from giraff_setup.ultrasonic.procedure import SPEED, TURN_SPEED, measure
from giraff_setup.ultrasonic.stand import Hearing
from giraff_sim.hosts.process import Process
from giraff_sim.truth import draw_truth
from giraff_sim.world.room import Pose as TruePose
from tests.loop.loops import SETTINGS
from tests.loop.motions import Stage, stage
from tests.sim.robots import proving_room
from tests.unit.motion.claims import CALIBRATED
from tests.unit.setup.walls import RANGES, TapePerson

_PINGS: Final = 24
_WALL: Final = 4.0  # m, x of the room's wall
_LONGEST: Final = 60.0  # s


class _Listener:
    """The part of the command that hears."""

    link = None
    timers = ()

    def __init__(self, process: Process, hearing: Hearing) -> None:
        self._hearing = hearing
        self._inboxes: list[Inbox[Any]] = [process.inbox(ODOM), process.inbox(RANGE), process.inbox(LEASE)]

    def turn(self, now: float) -> None:
        del now
        for inbox in self._inboxes:
            for sample in inbox.pop_all():
                self._hearing.on_sample(sample)

    def end(self) -> None:
        """Nothing is left to say."""


class _SimulatedStand:
    """As `Stand`, by the services."""

    def __init__(self, made: Stage) -> None:
        self._stage = made
        self.hearing = Hearing()
        made.loop.launch("listener", self._listener, made.loop.hosts["operator"])
        made.run(0.2)

    def place(self) -> Pose:
        assert self.hearing.place is not None
        return self.hearing.place

    def listen(self, sensors: Sequence[str], pings: int) -> list[Echo]:
        self.hearing.echoes.clear()
        while any(Counter(echo.sensor for echo in self.hearing.echoes)[name] < pings for name in sensors):
            self._stage.run(0.1)
        return list(self.hearing.echoes)

    def perform(self, steps: Sequence[Step]) -> tuple[MotionResult, list[Echo]]:
        self.hearing.echoes.clear()
        self._stage.begin(MotionGo, steps=tuple(steps), speed=SPEED, turn_speed=TURN_SPEED)
        self._stage.until_ended(_LONGEST)
        result = result_of(self._stage.state, self._stage.state.outcome, str(self._stage.state.reason), begun=True)
        assert result.arrived, result
        return result, list(self.hearing.echoes)

    def idle(self) -> str:
        return ""

    def taped(self, side: str) -> float:
        pose = self._stage.loop.simulation.world.plant.pose
        half = SETTINGS.robot.track_width / 2.0 * (1.0 if side == "left" else -1.0)
        return _WALL - (pose.x - math.sin(pose.yaw) * half)

    def _listener(self, process: Process) -> Service:
        return _Listener(process, self.hearing)


def test_the_front_sensors_of_a_drawn_robot_are_found() -> None:
    robot = msgspec.structs.replace(SETTINGS.robot, calibration=CALIBRATED)
    truth = draw_truth("calibrated", RANGES, 4, CALIBRATED)
    room = proving_room(TruePose(_WALL - 0.75, 0.0, math.radians(2.0)), _WALL)
    with stage(room, settings=msgspec.structs.replace(SETTINGS, robot=robot), truth=truth, seed=4) as made:
        stand = _SimulatedStand(made)
        ahead = {name: pose for name, pose in robot.of(Ultrasonic).items() if name != "rear"}
        person = TapePerson(stand, 4)
        told = measure(person, stand, msgspec.structs.replace(robot, sensors=ahead), _PINGS)
        made.run(2.5)
        assert not stand.hearing.motion_holds_lease, "the guard ends it after 2 s"
        print(f"{made.now:.1f} s of simulated time")
    for name, (filed, found, why) in told.items():
        assert found is not None, why
        off_x = found.x - filed.x - truth.sensor_xs[filed.index]
        off_yaw = found.yaw - filed.yaw - truth.sensor_yaws[filed.index]
        off_scale = found.scale - truth.sonar_scales[filed.index]
        print(f"{name}: {off_x * 1000.0:.1f} mm, {math.degrees(off_yaw):.2f}°, {off_scale:.4f} off")
        assert off_x == pytest.approx(0.0, abs=0.010)
        assert off_yaw == pytest.approx(0.0, abs=math.radians(2.0))
        assert off_scale == pytest.approx(0.0, abs=0.0075)
