"""Makes tests/unit/replay/data/drive.mcap anew.

`python -m tests.functional.desk.make_drive`, on a machine that does nothing else.

A simulated robot is recorded from before its services start: it is armed, backs, drives ahead until a wall stops it,
backs, turns, meets a wall that comes from nowhere, and is laid down.
"""

import sys
import tempfile
import time
from pathlib import Path

from tests.support.process_robot import FULL_TILT, PROVING_ROOM, SERVICES, ProcessRobot
from tests.support.recorders import giraff_process
from tests.unit.replay.drive import DRIVE

_MOVES = (
    (-FULL_TILT, 0.0, 1.5),
    (FULL_TILT, 0.0, 9.0),
    (-FULL_TILT, 0.0, 2.0),
    (FULL_TILT / 2.0, FULL_TILT, 3.0),
    (FULL_TILT, FULL_TILT / 3.0, 2.5),
    (0.0, 0.0, 0.5),
    (FULL_TILT, 0.0, 1.5),
)
"""Tilt (x, y, m/s²) and for how long, s."""


def make(path: Path) -> None:
    """About 24 s of it."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.unlink(missing_ok=True)
    with tempfile.TemporaryDirectory(prefix="drive-") as folder:
        world = Path(folder) / "world.toml"
        world.write_text(PROVING_ROOM)
        robot = ProcessRobot(Path(folder), world, "host")
        try:
            with giraff_process(robot, "record", "-o", str(path), stdout=sys.stdout, stderr=sys.stderr) as recorder:
                time.sleep(2.0)
                for service in SERVICES:
                    robot.start(service)
                robot.wait("the first accepted drive frame", lambda: robot.accepted() > 0, 20.0)
                robot.arm()
                for x, y, seconds in _MOVES:
                    robot.hold(x, y)
                    robot.run(seconds)
                at = robot.simulator.state()
                robot.simulator.add_wall("wall", [(at.x + 0.5, at.y - 2.0), (at.x + 0.5, at.y + 2.0)])
                robot.run(1.5)
                robot.stop("joystick")
                robot.run(1.5)
                recorder.terminate()
                recorder.wait(10.0)
        finally:
            robot.close()


if __name__ == "__main__":
    make(DRIVE)
