"""Parts of a robot that have a frame of their own: the tables `[robot.frames.<name>]`."""

import math
from collections.abc import Collection, Mapping
from typing import Annotated, Final, Protocol

import msgspec

from giraff_core.bounds import Bounds, check_bounds
from giraff_schemas.frames import BASE_FRAME, MAP_FRAME, ODOM_FRAME, Transform
from giraff_schemas.topics import require_chunk

PLACE: Final = Bounds(-2.0, 2.0, "m")
ANGLE: Final = Bounds(-math.tau, math.tau, "rad")


class Posed(Protocol):
    """Something at a place of the robot: metres, radians."""

    @property
    def x(self) -> float: ...
    @property
    def y(self) -> float: ...
    @property
    def z(self) -> float: ...
    @property
    def roll(self) -> float: ...
    @property
    def pitch(self) -> float: ...
    @property
    def yaw(self) -> float: ...


def fixed_transform(child: str, pose: Posed, parent: str = BASE_FRAME) -> Transform:
    """Return where the frame `child` is for good."""
    return Transform(
        parent=parent,
        child=child,
        x=pose.x,
        y=pose.y,
        z=pose.z,
        roll=pose.roll,
        pitch=pose.pitch,
        yaw=pose.yaw,
        fixed=True,
    )


class PartPose(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Where a part is in its parent: metres, radians. A laser, a camera, what a calibration has found."""

    parent: str = BASE_FRAME
    """`base_link`, a sensor's frame, or another of these."""
    x: Annotated[float, PLACE] = 0.0
    """m ahead."""
    y: Annotated[float, PLACE] = 0.0
    """m to the left."""
    z: Annotated[float, PLACE] = 0.0
    """m up. Not below the floor, where `base_link` is."""
    roll: Annotated[float, ANGLE] = 0.0
    """rad. About the parent's fixed axes, first roll, then pitch, then yaw (REP-103)."""
    pitch: Annotated[float, ANGLE] = 0.0
    """rad; positive: what looks ahead looks down."""
    yaw: Annotated[float, ANGLE] = 0.0
    """rad, counter-clockwise positive."""

    def __post_init__(self) -> None:
        check_bounds(self)
        if self.parent == BASE_FRAME and self.z < 0.0:
            raise ValueError(
                f"z is {self.z:g} m: {BASE_FRAME} is on the floor, so z must be 0 or more; "
                "name the parent if it is in another part"
            )

    def transform(self, name: str) -> Transform:
        """Of the part of this name."""
        return fixed_transform(name, self, self.parent)


def check_parts(parts: Mapping[str, PartPose], sensors: Collection[str]) -> None:
    """ValueError where these are no tree below `base_link`. `sensors`: their frames."""
    taken = {
        MAP_FRAME: "the floor plan's",
        ODOM_FRAME: "odometry's",
        BASE_FRAME: "the robot's own",
        **dict.fromkeys(sensors, "a sensor's"),
    }
    there = [BASE_FRAME, *sensors, *parts]
    for name, part in parts.items():
        require_chunk(name)
        if name in taken:
            raise ValueError(f"frames.{name}: {name} is {taken[name]} frame already; give it another name")
        if part.parent not in there:
            others = ", ".join(frame for frame in there if frame != name)
            raise ValueError(f"frames.{name} has the parent {part.parent!r}, which is no part of the robot: {others}")
    for name in parts:
        chain = [name]
        while chain[-1] in parts:
            above = parts[chain[-1]].parent
            if above in chain:
                round_about = " in ".join([*chain[chain.index(above) :], above])
                raise ValueError(f"frames are in each other: {round_about}; let one of them have another parent")
            chain.append(above)
