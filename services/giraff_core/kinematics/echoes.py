"""Where ultrasonic sensors have heard something, as cells of the floor in `odom`. People look at it. No guard does."""

from collections.abc import Mapping
from contextlib import suppress
from typing import Final

from giraff_core.kinematics.parts import Posed
from giraff_core.kinematics.pose import Pose
from giraff_core.kinematics.pose_history import FrameError, PoseHistory
from giraff_schemas.messages import Odometry, Range
from giraff_schemas.requests import EchoMap

CELL: Final = 0.05
"""m. Side of a cell."""
_FARTHEST: Final = 1e5
"""m from the origin. No robot hears so far, but anybody on an open network may say so."""
MOST_CELLS: Final = 4000
"""Cells that are kept, an answer of 24 kB. A new one then replaces the one that was heard longest ago."""


class Echoes:
    """Echoes of one robot. All are forgotten when odometry begins anew or its pose is set."""

    def __init__(self, sensors: Mapping[str, Posed]) -> None:
        self._sensors = {name: Pose(each.x, each.y, each.yaw) for name, each in sensors.items()}
        self._history = PoseHistory()
        self._segment: tuple[str, int] | None = None
        self._cells: dict[tuple[int, int], None] = {}
        """The cell that was heard last is at the end."""

    @property
    def points(self) -> list[tuple[float, float]]:
        """The middles of the cells, m."""
        return [(column * CELL, row * CELL) for column, row in self._cells]

    def map(self, instance: str) -> EchoMap:
        """Return all cells. `instance`: random name of the odometry in whose frame they are."""
        columns, rows = tuple(x for x, _ in self._cells), tuple(y for _, y in self._cells)
        _, jumps = self._segment or ("", 0)
        return EchoMap(instance=instance, jumps=jumps, cell=CELL, columns=columns, rows=rows)

    def on_odometry(self, odometry: Odometry) -> bool:
        """Take the robot's pose. True: all cells were forgotten."""
        is_new = self._segment not in (None, odometry.segment)
        if is_new:
            self._history, self._cells = PoseHistory(), {}
        self._segment = odometry.segment
        self._history.on_odometry(odometry)
        return is_new

    def add(self, reading: Range) -> bool:
        """Place an echo where the robot was when it was measured. True: the cell is new."""
        sensor = self._sensors.get(reading.sensor)
        if sensor is None or reading.range is None or reading.tick is None:
            return False
        with suppress(FrameError):  # it is not known where the robot was
            place = Pose(reading.range, 0.0, 0.0).placed_in(sensor).placed_in(self._history.at(reading.tick))
            if abs(place.x) < _FARTHEST and abs(place.y) < _FARTHEST:
                return self._keep((round(place.x / CELL), round(place.y / CELL)))
        return False

    def join(self, earlier: EchoMap) -> bool:
        """Take cells that somebody else has kept. False: they are of another frame, or of cells of another size."""
        if (earlier.instance, earlier.jumps) != self._segment or earlier.cell != CELL:
            return False
        own, self._cells = self._cells, {}
        for cell in (*zip(earlier.columns, earlier.rows, strict=True), *own):
            self._keep(cell)
        return True

    def _keep(self, cell: tuple[int, int]) -> bool:
        is_new = cell not in self._cells
        self._cells.pop(cell, None)
        self._cells[cell] = None
        if len(self._cells) > MOST_CELLS:
            del self._cells[next(iter(self._cells))]
        return is_new
