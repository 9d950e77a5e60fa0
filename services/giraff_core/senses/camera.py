"""Cameras: where they are, and their lenses."""

import math
from typing import Annotated

from giraff_core.bounds import Bounds, check_bounds
from giraff_core.kinematics.parts import ANGLE, PLACE, fixed_transform
from giraff_core.senses.sense import Sense
from giraff_schemas.frames import Transform, camera_frame


class Camera(Sense, frozen=True, kw_only=True, tag="camera"):
    """A camera in `base_link` (metres, radians), and its lens. `giraff calibrate camera` measures what is here.

    The lens is that of a plumb-bob model, as ROS and OpenCV have it: pixels from the middle of the left upper one.
    """

    x: Annotated[float, PLACE] = 0.0
    y: Annotated[float, PLACE] = 0.0
    z: Annotated[float, Bounds(0.02, 3.0, "m", "how high above the floor is its lens?")]
    """m above the floor."""
    roll: Annotated[float, ANGLE] = 0.0
    """rad. About the fixed axes of `base_link`, first roll, then pitch, then yaw (REP-103)."""
    pitch: Annotated[float, Bounds(-math.pi / 2, math.pi / 2, "rad")] = 0.0
    """rad; positive: it looks down."""
    yaw: Annotated[float, ANGLE] = 0.0
    width: Annotated[int, Bounds(64, 1920, "px")] = 320
    height: Annotated[int, Bounds(48, 1080, "px")] = 240
    focal_x: Annotated[float, Bounds(10.0, 10_000.0, "px")] = 230.0
    """px, at this width; 230 of 320 is 70 degrees wide."""
    focal_y: Annotated[float, Bounds(10.0, 10_000.0, "px")] = 230.0
    center_x: Annotated[float | None, Bounds(0.0, 1920.0, "px")] = None
    """px; None: the picture's middle."""
    center_y: Annotated[float | None, Bounds(0.0, 1080.0, "px")] = None
    distortion: tuple[float, float, float, float, float] = (0.0, 0.0, 0.0, 0.0, 0.0)
    """k1, k2, p1, p2, k3."""

    def __post_init__(self) -> None:
        check_bounds(self)
        if not all(math.isfinite(value) for value in self.distortion):
            raise ValueError("distortion has a number that is not finite")

    def transform(self, name: str) -> Transform:
        """Return where the camera of this name is."""
        return fixed_transform(camera_frame(name), self)
