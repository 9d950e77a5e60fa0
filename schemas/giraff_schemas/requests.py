"""What one service is asked, and what it answers: the emergency stop is base's, the pose odometry's.

They are MessagePack maps as samples are, checked where they are made and where they arrive.
"""

import msgspec

from giraff_schemas.checks import require_finite
from giraff_schemas.messages import RobotTime
from giraff_schemas.trouble import NO_TROUBLE, Trouble


class EStopEngage(msgspec.Struct, frozen=True, kw_only=True):
    """Asks base to stop at once and stay so."""

    by: str
    reason: Trouble = NO_TROUBLE
    off: bool = False
    """Also switch off a drive that holds the robot up while it is stopped. A stop that is off stays off until it is
    reset."""


UNREADABLE_STOP = EStopEngage(
    by="somebody unknown", reason=Trouble("a request that cannot be read", "see who asks for a stop")
)
"""Stop that base makes of a request that it cannot read: a stop is not refused for its form."""


class EStopReset(msgspec.Struct, frozen=True, kw_only=True):
    """Asks base to clear one latch. It permits motion and never causes it."""

    by: str
    id: int
    tick: RobotTime | None
    """Of the human's wish: an old reset clears nothing newer."""
    engaged_ns: int | None = None
    """`EStop.engaged_ns` as it was shown: base clears no stop that has a newer one. None: it was not shown."""


class EStopAnswer(msgspec.Struct, frozen=True, kw_only=True):
    """What base did with either."""

    done: bool
    """The state is as asked, and on disk."""
    engaged: bool
    id: int
    reason: Trouble = NO_TROUBLE
    """Cause of a refusal."""
    instance: str = ""
    """Of the base that answers. Its `estop` samples carry it, too: without them an answer proves no stop."""
    unheard_stops_s: float = 0.0
    """s. Base does not hear its board, which stops by itself within this time. 0: base hears it."""


class OdomReset(msgspec.Struct, frozen=True, kw_only=True):
    """Asks odometry to begin anew here: pose, path and covariance are 0."""

    by: str
    id: int
    """Random, of this wish: asked again with the same one, it is not done again."""


class OdomSetPose(msgspec.Struct, frozen=True, kw_only=True):
    """Asks odometry to take the robot to be elsewhere: m and rad, in `odom`. The path goes on."""

    by: str
    id: int
    """As of `OdomReset`."""
    x: float
    y: float
    yaw: float
    """rad, any number of turns."""
    position_sd: float = 0.0
    """m; how sure that is, on either axis, as a standard deviation."""
    yaw_sd: float = 0.0
    """rad; the same of the heading."""

    def __post_init__(self) -> None:
        require_finite(self, self.x, self.y, self.yaw, self.position_sd, self.yaw_sd)
        if self.position_sd < 0.0 or self.yaw_sd < 0.0:
            raise ValueError(f"position_sd {self.position_sd} and yaw_sd {self.yaw_sd} must not be negative")


class OdomEchoes(msgspec.Struct, frozen=True, kw_only=True):
    """Asks odometry where the ultrasonic sensors have heard something since it began."""

    by: str


class EchoMap(msgspec.Struct, frozen=True, kw_only=True):
    """Cells of the floor in `odom` from which an echo came. The one that was heard last is the last."""

    instance: str
    """Random name of the start of the odometry in whose frame the cells are."""
    jumps: int
    """`Odometry.jumps` of that frame: after another jump the cells are of no use."""
    cell: float
    """m. Side of a cell. The middle of a cell is at its column and row times this."""
    columns: tuple[int, ...]
    rows: tuple[int, ...]

    def __post_init__(self) -> None:
        require_finite(self, self.cell)
        if len(self.columns) != len(self.rows):
            raise ValueError(f"{len(self.columns)} columns and {len(self.rows)} rows: each cell has both")


class OdomAnswer(msgspec.Struct, frozen=True, kw_only=True):
    """What odometry did with either."""

    done: bool
    jumps: int
    """`Odometry.jumps` of the samples from now on."""
    reason: Trouble = NO_TROUBLE
    """Cause of a refusal."""
