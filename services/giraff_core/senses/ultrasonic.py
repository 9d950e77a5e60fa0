"""Ultrasonic sensors: where they are, and how they hear."""

import math
from typing import Annotated, ClassVar, Final

from giraff_core.bounds import Bounds, check_bounds
from giraff_core.kinematics.parts import ANGLE, PLACE, fixed_transform
from giraff_core.senses.sense import Evidence, Sense, Strip, Summary, arc
from giraff_schemas.frames import Transform, range_frame
from giraff_schemas.messages import Range
from giraff_schemas.topics import RANGE, Topic
from giraff_schemas.trouble import NO_TROUBLE, Trouble
from giraff_schemas.wire import RANGE_SENSORS

_FAULT: Final = Trouble("fault")
_STEEPEST: Final = math.pi / 4


class Ultrasonic(Sense, frozen=True, kw_only=True, tag="hc-sr04"):
    """An ultrasonic sensor in `base_link`: metres, radians. The defaults of its cone are those of an HC-SR04.

    The guard and the simulation go by x, y and yaw: on a robot that stands upright each sensor looks level to them.
    They use z where a robot leans. roll and pitch are for who asks where its frame is. The simulator has a cone of its
    own, which is drawn by `[sim.truth]`.
    """

    TOPIC: ClassVar[Topic[Range]] = RANGE

    index: int
    """Number of the sensor on the ranger board."""
    x: Annotated[float, PLACE]
    y: Annotated[float, PLACE]
    z: Annotated[float, Bounds(0.0, 2.0, "m", "how many metres above the floor is it?")] = 0.0
    """m above the floor. A robot that balances needs it: it leans, and the sensor looks at the floor then."""
    roll: Annotated[float, ANGLE] = 0.0
    """rad. About the fixed axes of `base_link`, first roll, then pitch, then yaw (REP-103)."""
    pitch: Annotated[float, Bounds(-_STEEPEST, _STEEPEST, "rad")] = 0.0
    """rad; positive: it looks down. One that looks more up or down than ahead says nothing of the way."""
    yaw: Annotated[float, ANGLE]
    scale: Annotated[float, Bounds(0.95, 1.05, "", "is this a percentage?")] = 1.0
    """Factor on each range that its echoes give: warm air and the board's clock are in it. `giraff calibrate ranger`
    measures it, with x and yaw."""
    half_cone: Annotated[float, Bounds(math.radians(1.0), math.radians(45.0), "rad")] = math.radians(7.5)
    """rad; an echo may come from anywhere this far off the sensor's axis."""
    incidence: Annotated[float, Bounds(math.radians(5.0), math.radians(85.0), "rad")] = math.radians(25.0)
    """rad between a surface's normal and the sensor's axis, up to which it reads reliably."""
    reach: Annotated[float, Bounds(0.1, 10.0, "m")] = 4.0
    """m beyond which nothing is heard: what `clear` counts for."""

    def __post_init__(self) -> None:
        check_bounds(self)
        if not 0 <= self.index < RANGE_SENSORS:
            raise ValueError(f"index is {self.index}: the ranger board has 0..{RANGE_SENSORS - 1}")

    def transform(self, name: str) -> Transform:
        """Return where the sensor of this name is."""
        return fixed_transform(range_frame(name), self)

    @classmethod
    def summary(cls, sample: Range) -> Summary:
        """Return the distance that it heard."""
        text = sample.state if sample.range is None else f"{sample.range:.2f} m"
        trouble = (sample.reason or _FAULT) if sample.state == "fault" else NO_TROUBLE
        return Summary(text, sample.range, trouble)

    def field(self, footprint_radius: float) -> list[Strip]:
        """Return its cone."""
        del footprint_radius
        return [self._cone(self.reach)]

    def evidence(self, sample: Range, footprint_radius: float) -> Evidence:
        """Return the cone up to what it heard."""
        if sample.range is None:
            return Evidence() if sample.state == "fault" else Evidence(free=self.field(footprint_radius))
        cone = self._cone(min(sample.range, self.reach))
        return Evidence(free=[cone], seen=[cone[1:-1]])

    def _cone(self, far: float) -> Strip:
        here = self.x, self.y
        return [here, *arc(*here, far, self.yaw, self.half_cone), here]


HC_SR04: Final = Ultrasonic(index=0, x=0.0, y=0.0, yaw=0.0)
"""One in the robot's middle, with the defaults of its type."""
