"""What is sent to rerun: which thing at which path."""

from typing import Any, Final

import rerun as rr

Row = tuple[str, Any]
"""Path of an entity, and the archetype that is logged there."""

FLOOR: Final = "floor"


def turned(x: float, y: float, z: float, angle: float) -> dict[str, Any]:
    """A rotation about an axis."""
    return {"rotation_axis_angle": rr.RotationAxisAngle(axis=[x, y, z], radians=angle)}


def planar(parent: str, child: str, x: float, y: float, yaw: float) -> Row:
    """Where a frame is in its parent, on the floor."""
    at = rr.Transform3D(translation=[x, y, 0.0], **turned(0.0, 0.0, 1.0, yaw), parent_frame=parent, child_frame=child)
    return f"frames/{child}", at
