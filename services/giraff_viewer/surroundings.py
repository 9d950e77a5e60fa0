"""What stands around the robot: where its sensors heard something, and the room of a simulated one."""

from typing import Final

import rerun as rr

from giraff_core.kinematics.echoes import CELL, Echoes
from giraff_core.robot import RobotConfig
from giraff_core.senses import Ultrasonic
from giraff_schemas.messages import Odometry, Range, TruePose
from giraff_schemas.requests import EchoMap
from giraff_viewer.colours import ECHOES, ROOM
from giraff_viewer.rows import FLOOR, Row

_ECHOES: Final = f"{FLOOR}/echoes"
_ROOM: Final = f"{FLOOR}/room"
_BELOW: Final = 4.0
"""Order of drawing, below the walls of a map."""


class Surroundings:
    """All of it is in `odom`, one robot's."""

    def __init__(self, robot: RobotConfig) -> None:
        self._echoes = Echoes(robot.of(Ultrasonic))
        self._earlier: EchoMap | None = None
        self._is_news = False
        self._walls: tuple[object, ...] = ()
        self._has_map = False

    def begin(self) -> list[Row]:
        """Return the frame of everything here."""
        return [(path, rr.CoordinateFrame("odom")) for path in (_ECHOES, _ROOM)]

    def on_sample(self, sample: Odometry | Range) -> None:
        """Take a pose, or a reading."""
        if isinstance(sample, Range):
            self._is_news |= self._echoes.add(sample)
            return
        self._is_news |= self._echoes.on_odometry(sample)
        if self._earlier is not None:
            self._is_news |= self._echoes.join(self._earlier)
            self._earlier = None

    def begin_with(self, earlier: EchoMap) -> None:
        """Take what was heard before anybody looked. It counts from the next pose on, if that has the same frame."""
        self._earlier = earlier

    def draw_echoes(self) -> list[Row]:
        """Return the echoes, if there are others than before."""
        if not self._is_news:
            return []
        self._is_news = False
        dots = rr.Points2D(self._echoes.points, colors=[ECHOES], radii=[0.7 * CELL], draw_order=_BELOW)
        return [(_ECHOES, dots)]

    def on_truth(self, truth: TruePose) -> list[Row]:
        """Return the room, if a sample says another one than before."""
        if self._has_map or not truth.walls or truth.walls == self._walls:
            return []
        self._walls = truth.walls
        return [(_ROOM, rr.LineStrips2D(truth.walls, colors=[ROOM], radii=[0.02], draw_order=_BELOW))]

    def on_map(self, walls: tuple[object, ...]) -> list[Row]:
        """Return what takes the room away: a map shows the same walls where localization takes them to be."""
        if self._has_map or not walls:
            return []
        self._has_map = True
        return [(_ROOM, rr.LineStrips2D([]))] if self._walls else []
