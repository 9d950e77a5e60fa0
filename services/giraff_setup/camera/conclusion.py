"""What was found of a camera, in words, and as its table of the robot file."""

import math
from collections.abc import Sequence
from typing import Any, Final

import msgspec
import numpy as np

from giraff_core.senses import Camera
from giraff_setup.camera.lens import LensFit, lens_of
from giraff_setup.camera.picture import UnusableError
from giraff_setup.camera.sheet import FloorPose, middle_of

_LARGE_CHANGE: Final = 0.2
"""Share of the height or the focal length."""
_LARGE_TURN: Final = math.radians(10.0)


def calibrated(camera: Camera, fit: LensFit, pose: FloorPose) -> Camera:
    """Return the camera as it was found, rounded. Raises UnusableError where no robot file takes it."""
    lens = fit.lens
    try:
        return msgspec.structs.replace(
            camera,
            z=round(pose.z, 4),
            roll=round(pose.roll, 4),
            pitch=round(pose.pitch, 4),
            focal_x=round(lens.focal_x, 2),
            focal_y=round(lens.focal_y, 2),
            center_x=round(lens.center_x, 2),
            center_y=round(lens.center_y, 2),
            distortion=tuple(round(value, 5) for value in lens.distortion),
        )
    except ValueError as error:
        raise UnusableError(f"no camera is like this: {error}") from error


def changed(after: Camera) -> dict[str, Any]:
    """Return the fields that calibration sets."""
    names = ("z", "roll", "pitch", "width", "height", "focal_x", "focal_y", "center_x", "center_y", "distortion")
    return {name: getattr(after, name) for name in names}


def in_words(before: Camera, after: Camera, fit: LensFit, poses: Sequence[FloorPose]) -> str:
    """Tell the person what was found, and how sure it is."""
    was, pose = lens_of(before), middle_of(poses, before.width)
    heights = np.array([each.z for each in poses])
    z_sd = max(pose.z_sd, float(heights.std()))
    rows = [
        ("height", f"{after.z:.3f} ± {z_sd:.3f} m", f"{before.z:.3f} m"),
        ("pitch", f"{_degrees(after.pitch)} ± {_degrees(pose.pitch_sd)}°", f"{_degrees(before.pitch)}°"),
        ("roll", f"{_degrees(after.roll)}°", f"{_degrees(before.roll)}°"),
        ("focal length", f"{after.focal_x:.1f} ± {fit.focal_sd:.1f} px", f"{was.focal_x:.1f} px"),
        ("centre", f"{after.center_x:.1f}, {after.center_y:.1f} px", f"{was.center_x:.1f}, {was.center_y:.1f} px"),
        ("k1 k2 p1 p2", _distortion(after), _distortion(before)),
    ]
    lines = [f"{'':<14}{'found':<30}before", *(f"{name:<14}{found:<30}{old}" for name, found, old in rows)]
    lines.append(f"Error left: lens {fit.error:.2f} px, sheet {pose.error:.2f} px in {len(poses)} pictures.")
    changes = (
        ("height", abs(after.z / before.z - 1.0) > _LARGE_CHANGE),  # A3 and A5 have the form of A4
        ("pitch", abs(after.pitch - before.pitch) > _LARGE_TURN),
        ("focal length", abs(after.focal_x / before.focal_x - 1.0) > _LARGE_CHANGE),
    )
    lines += [
        f"Mind: the {name} is far from the one in the robot file; is that right, and was the sheet A4?"
        for name, far in changes
        if far
    ]
    return "\n".join(lines)


def _distortion(camera: Camera) -> str:
    return " ".join(f"{value:.3f}" for value in camera.distortion[:4])


def _degrees(angle: float) -> str:
    return f"{math.degrees(angle):.2f}"
