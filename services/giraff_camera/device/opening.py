"""Opens the camera at a path, or says why that cannot be."""

import errno
import fcntl
import os
import stat
import struct
from pathlib import Path
from typing import Final

from giraff_camera.device.image import Device, DeviceError
from giraff_camera.device.simulated import SimulatedCamera
from giraff_camera.device.v4l2 import V4l2Camera
from giraff_schemas.trouble import Trouble

# Of linux/videodev2.h.
_VIDIOC_QUERYCAP: Final = 0x80685600
_VIDIOC_REQBUFS: Final = 0xC0145608
_CAPABILITIES: Final = struct.Struct("=84xII12x")
"""All that the driver can do, and what this of its devices can."""
_DEVICE_CAPS: Final = 0x80000000
_CAPTURES: Final = {0x1: 1, 0x1000: 9}
"""V4L2_CAP_VIDEO_CAPTURE and _MPLANE, with the type of their buffers. The second device of a USB camera has neither."""
_NO_BUFFERS: Final = struct.Struct("=IIIII")
_MEMORY_MMAP: Final = 1

_LIKELY: Final = {
    errno.ENOENT: Trouble("no such camera", "plug it in, or correct `device` of [camera] in the robot file"),
    **dict.fromkeys(
        (errno.EACCES, errno.EPERM),
        Trouble(
            "not permitted", "add this user to the group that owns it: sudo usermod -aG video USER, then log in again"
        ),
    ),
    errno.EBUSY: Trouble("another program uses the camera", "end that one; `sudo fuser -v DEVICE` names it"),
    **dict.fromkeys((errno.ENXIO, errno.ENODEV, errno.EIO), Trouble("unplugged", "it is opened again when it is back")),
}
"""What an error number probably means."""
_NO_CAMERA: Final = Trouble(
    "no camera",
    "correct `device` of [camera] in the robot file; /dev/v4l/by-id lists cameras, by the names that end in index0",
)


def open_camera(path: str, width: int, height: int, rate: float) -> Device:
    """Open the camera of the kernel's or the simulated one, by what is at `path`. Raises DeviceError.

    It may take seconds.
    """
    try:
        mode = Path(path).stat().st_mode
        if stat.S_ISSOCK(mode):
            return SimulatedCamera(path, width, height, rate)
        if not stat.S_ISCHR(mode):
            raise DeviceError(_NO_CAMERA.of(path))
        _check(path)
    except OSError as error:
        raise DeviceError(_LIKELY.get(error.errno or 0, Trouble(error.strerror or str(error))).of(path)) from error
    return V4l2Camera(path, width, height, rate)


def _check(path: str) -> None:
    """Ask what OpenCV does not tell. Raises OSError, and DeviceError where it is no camera."""
    with os.fdopen(os.open(path, os.O_RDWR | os.O_NONBLOCK | os.O_CLOEXEC), "rb+", buffering=0) as device:
        answer = bytearray(_CAPABILITIES.size)
        try:
            fcntl.ioctl(device, _VIDIOC_QUERYCAP, answer)
        except OSError as error:
            if error.errno in (errno.ENOTTY, errno.EINVAL):
                raise DeviceError(_NO_CAMERA.of(path)) from error
            raise
        whole, own = _CAPABILITIES.unpack(answer)
        can = own if whole & _DEVICE_CAPS else whole
        kinds = [kind for capability, kind in _CAPTURES.items() if can & capability]
        if not kinds:
            raise DeviceError(_NO_CAMERA.of(path))
        # To ask for no buffers changes nothing, and fails while another program has some.
        try:
            fcntl.ioctl(device, _VIDIOC_REQBUFS, bytearray(_NO_BUFFERS.pack(0, kinds[0], _MEMORY_MMAP, 0, 0)))
        except OSError as error:
            if error.errno == errno.EBUSY:
                raise
