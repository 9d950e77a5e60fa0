"""`giraff move` and `giraff turn` beside a `giraff run` in which nobody drives, by the world's truth.

A motion that a machine which stands still has ended is asked for anew.
"""

import math
import signal
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from giraff_schemas.messages import TruePose
from giraff_schemas.topics import TRUE_POSE
from tests.support.observer import Observer
from tests.support.process_robot import PATIENCE
from tests.support.runs import GIRAFF, SMALL_ROOM, Command, command_in, line_of
from tests.support.waiting import wait

MIDDLE = 0.5
"""m, x in the small room: what begins on one side of it moves towards the other."""


@pytest.fixture
def command(tmp_path: Path) -> Iterator[Command]:
    (tmp_path / "world.toml").write_text(SMALL_ROOM)
    with command_in(tmp_path) as made:
        yield made


@pytest.fixture
def observer(command: Command) -> Iterator[Observer]:
    made = Observer(command.environment)
    yield made
    made.close()


def begin(command: Command, *words: str) -> subprocess.Popen[str]:
    """Another `giraff` beside the run."""
    streams: dict[str, Any] = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    return subprocess.Popen([str(GIRAFF), *words], env=command.environment, cwd=command.directory, **streams)


def truth(observer: Observer) -> TruePose:
    """Where the robot is, by the world, in a word that is said from now on."""
    before, heard = observer.newest(TRUE_POSE), list[TruePose]()

    def is_heard() -> bool:
        newest = observer.newest(TRUE_POSE)
        heard[:] = [newest] if newest is not None and newest is not before else []
        return bool(heard)

    wait(is_heard, PATIENCE, what="the truth")
    return heard[0]


def arrives(command: Command, metres: str) -> bool:
    """Whether `giraff move` does, and not the machine ends it."""
    with begin(command, "move", metres) as moving:
        print(*moving.communicate(timeout=PATIENCE))
    return moving.returncode == 0


def is_interrupted(command: Command) -> bool:
    """Whether Ctrl-C ends two turns to the right on their way, and not the machine."""
    with begin(command, "turn", "--", "-720deg") as turning:
        assert turning.stdout is not None
        if any("| moving |" in line for line in turning.stdout):
            turning.send_signal(signal.SIGINT)
        _, complaint = turning.communicate(timeout=PATIENCE)
    print(complaint)
    return turning.returncode == 1 and "stopped: cancelled by " in complaint


def test_it_moves_a_metre_and_ctrl_c_stops_a_turn(command: Command, observer: Observer) -> None:
    with command.start("--hand", "none", "--boards", "host", "--world", "world.toml", local=False) as process:
        line_of(process, " | ")
        observer.follow(TRUE_POSE)
        began = list[TruePose]()

        def has_moved() -> bool:
            began.append(truth(observer))
            return arrives(command, "1.0" if began[-1].x < MIDDLE else "-1.0")

        wait(has_moved, PATIENCE, what="a metre")
        there = truth(observer)
        assert math.dist((began[-1].x, began[-1].y), (there.x, there.y)) == pytest.approx(1.0, abs=0.03)
        wait(lambda: is_interrupted(command), PATIENCE, what="a turn that is stopped")
        stopped, later = truth(observer), truth(observer)
        assert later.tick.robot_ns > stopped.tick.robot_ns
        assert (later.x, later.y, later.yaw) == pytest.approx((stopped.x, stopped.y, stopped.yaw), abs=0.002)
        assert abs(math.remainder(later.yaw - there.yaw, math.tau)) > 0.02
        process.send_signal(signal.SIGTERM)
        assert process.wait(PATIENCE) == 0
    assert command.leaves_nothing()
