"""A robot that is driven against a wall says so by its bumper, and one without bumpers says nothing of them."""

from typing import Any, Final

import msgspec

from giraff_cli.replay.policies import RecordedSamples, replay_guard
from giraff_schemas.messages import Sample
from giraff_schemas.wire import BoardKind, ResetCause
from giraff_sim.hosts.process import Observer, Process
from giraff_sim.world.room import Pose
from giraff_sim.world.sonar import SonarFault
from tests.loop.loops import FULL_TILT, SETTINGS, arm, closed_loop, hold
from tests.sim.robots import room_with_wall
from tests.support.robots import BUMPED

WALL: Final = 2.0
NEAR: Final = Pose(WALL - BUMPED.footprint_radius - 0.05, 0.0, 0.0)


class _Recorder(Observer):
    """Records all that the services publish."""

    def __init__(self) -> None:
        self.samples = RecordedSamples()

    def said(self, process: Process, sample: Any) -> None:
        del process
        if isinstance(sample, Sample):
            self.samples.add(sample)


def test_a_wall_that_no_sonar_hears_pushes_the_front_bumper() -> None:
    settings, recorder = msgspec.structs.replace(SETTINGS, robot=BUMPED), _Recorder()
    with closed_loop(room_with_wall(WALL, NEAR), settings, observer=recorder) as loop:
        for sonar in loop.simulation.world.sonars.values():
            sonar.fault = SonarFault.DEAF
        arm(loop)
        front, back = loop.newest["bumper/front"], loop.newest["bumper/back"]
        assert (front.pressed, back.pressed) == (False, False)
        hold(loop, x=FULL_TILT)
        touched_ns = 0
        while not loop.newest["bumper/front"].pressed and loop.simulation.now_us < 6e6:
            loop.step()
            if loop.simulation.world.bumpers[0].is_open(loop.simulation.world.plant.pose):
                touched_ns = touched_ns or loop.robot_ns
        pushed = loop.newest["bumper/front"]
        assert touched_ns > 0
        assert (pushed.pressed, loop.newest["bumper/back"].pressed) == (True, False)
        assert abs(pushed.tick.robot_ns - touched_ns) < 40_000_000
        pushed_us = loop.simulation.now_us
        loop.run(0.6)
        last = loop.simulation.record.window(pushed_us, loop.simulation.now_us).last_driven_us
        assert last is None or last - pushed_us < 60_000, "it still pushes against the wall"
        assert "front is pushed" in str(loop.newest["guard"].forward.reason)
        loop.simulation.reset(BoardKind.RANGER, ResetCause.WATCHDOG)
        loop.run(0.5)
        asked_anew = loop.newest["bumper/front"]
        assert (asked_anew.pressed, asked_anew.seq > pushed.seq + 2) == (True, True)
    replayed = replay_guard(recorder.samples, settings.guard, BUMPED)
    assert [each.first for each in replayed] == ["", "", ""]
    assert [each.equal for each in replayed] == [each.compared for each in replayed]
    assert min(each.compared for each in replayed) > 15


def test_a_cut_wire_stops_its_way_and_no_other() -> None:
    settings = msgspec.structs.replace(SETTINGS, robot=BUMPED)
    with closed_loop(room_with_wall(6.0), settings) as loop:
        arm(loop)
        hold(loop, x=FULL_TILT)
        loop.run(0.8)
        loop.simulation.world.bumpers[0].is_cut = True
        cut_us = loop.simulation.now_us
        loop.run(0.6)
        last = loop.simulation.record.window(cut_us, loop.simulation.now_us).last_driven_us
        assert last is not None
        assert (last - cut_us) * 1e-6 <= 0.45
        hold(loop, x=-FULL_TILT)
        loop.run(0.4)
        assert loop.newest["wheels"].left_velocity < -0.1
        loop.simulation.world.bumpers[0].is_cut = False
        loop.run(1.6)  # as slowly as a rear sensor that has proved nothing allows
        hold(loop, x=FULL_TILT)
        loop.run(0.8)
        assert loop.newest["wheels"].left_velocity > 0.1


def test_a_robot_without_bumpers_says_nothing_of_them() -> None:
    with closed_loop(room_with_wall(WALL)) as loop:
        loop.run(0.3)
        assert [key for key in loop.newest if key.startswith("bumper")] == []
