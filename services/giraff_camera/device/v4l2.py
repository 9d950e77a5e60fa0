"""A camera of the kernel's, by OpenCV."""

import time
from collections import deque
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from giraff_camera.device.image import DeviceError, Image, cv2
from giraff_core.picture.header import Header, HeaderError, read_jpeg
from giraff_node.process.c_library import muted_c_stderr
from giraff_schemas.trouble import Trouble

_BUFFERS: Final = 2
"""With one, a camera that sends without a pause loses each second picture. A thread that always reads empties both."""
_MANUAL_EXPOSURE: Final = 1
"""Value of V4L2_CID_EXPOSURE_AUTO. In other modes a camera may report an exposure time that it does not use."""
_EXPOSURE_UNIT: Final = 1e-4
"""s, of V4L2_CID_EXPOSURE_ABSOLUTE."""
_MOST_TORN: Final = 10
"""Torn pictures in a row that are passed over."""
_COMPRESSED: Final = frozenset(cv2.VideoWriter.fourcc(*each) for each in ("MJPG", "JPEG"))


class V4l2Camera:
    """An open camera. It gives pictures of the size that the lens was calibrated for, or none."""

    def __init__(self, path: str, width: int, height: int, rate: float, backend: int = cv2.CAP_V4L2) -> None:
        """Open the camera at `path`. Raises DeviceError. `backend`: of OpenCV."""
        self._path, self._width, self._height = path, width, height
        self._opened = time.monotonic()
        self._capture = capture = cv2.VideoCapture(path, backend)
        if not capture.isOpened():
            raise DeviceError(Trouble(f"{path}: the camera does not start", "unplug it, and plug it in again"))
        # The compressed form first: sizes and rates depend on it. A camera without it keeps its own.
        capture.set(cv2.CAP_PROP_FOURCC, cv2.VideoWriter.fourcc(*"MJPG"))
        capture.set(cv2.CAP_PROP_FRAME_WIDTH, width)
        capture.set(cv2.CAP_PROP_FRAME_HEIGHT, height)
        capture.set(cv2.CAP_PROP_FPS, max(1.0, rate))
        capture.set(cv2.CAP_PROP_BUFFERSIZE, _BUFFERS)
        if capture.get(cv2.CAP_PROP_FOURCC) in _COMPRESSED:
            # OpenCV would decode what says to be huge, and OpenCV 4 fills what is torn with grey. `_decoded` does not.
            capture.set(cv2.CAP_PROP_CONVERT_RGB, 0)
        given = capture.get(cv2.CAP_PROP_FPS)
        self._period = 1.0 / given if given > 0.0 else 1.0 / rate
        buffers = max(_BUFFERS, int(capture.get(cv2.CAP_PROP_BUFFERSIZE)))
        self._queued = deque([self._opened] * buffers, buffers)
        """s. When the driver got each of its buffers to fill, the oldest first."""
        self._sends_ends = False
        """The camera has sent a JPEG with its end marker. Some cameras never do."""

    def read(self) -> Image:
        """Wait for the next picture that is whole. Raises DeviceError."""
        for _ in range(_MOST_TORN):
            try:
                grabbed = self._capture.grab()
                raw = self._capture.retrieve()[1] if grabbed else None
                pixels = None if raw is None else self._decoded(raw)
            except cv2.error as error:
                raise DeviceError(Trouble(f"{self._path}: OpenCV cannot read the picture: {error.err}")) from error
            if not grabbed:
                raise DeviceError(self._why_silent())
            taken = self._taken(time.monotonic())
            if pixels is not None:
                return Image(self._sized(pixels), taken, self._exposure())
        raise DeviceError(
            Trouble(
                f"{self._path}: {_MOST_TORN} pictures in a row were torn", "check its cable, and give it a port alone"
            )
        )

    def close(self) -> None:
        """Give the camera back."""
        self._capture.release()

    def _decoded(self, raw: Any) -> NDArray[np.uint8] | None:
        """Return the pixels of what OpenCV gave, which may be a JPEG; None: it is torn. Raises DeviceError.

        A camera that has sent an end marker is held to it: its pictures without one are torn. Of a camera that has sent
        none yet, a picture counts as whole if its last block was there.
        """
        array = np.asarray(raw, np.uint8)
        if array.ndim == 3 and array.shape[2] == 3:
            return array
        try:
            header = read_jpeg(array.tobytes())
        except HeaderError:
            return None
        if not header.fits(self._width, self._height):
            raise self._misfit(header.width, header.height, "much larger")
        self._sends_ends = self._sends_ends or header.is_ended
        if not header.is_ended:
            grey = None if self._sends_ends else _pixels(header, cv2.IMREAD_GRAYSCALE)
            if grey is None or header.is_cut(grey[header.last_block].tobytes()):
                return None
        return _pixels(header, cv2.IMREAD_COLOR)

    def _taken(self, now: float) -> float:
        """The latest moment that is surely before the exposure began.

        The driver's time is that of the first line (USB cameras) or of the last one (others): at most a period later.
        Without it, the picture is not older than the moment when the driver got its buffer.
        """
        driver = self._capture.get(cv2.CAP_PROP_POS_MSEC) * 1e-3
        queued = self._queued[0]
        self._queued.append(now)
        # Before the camera was opened there was no picture: that is another clock, or none.
        return max(self._opened, (driver if self._opened <= driver <= now else queued) - self._period)

    def _exposure(self) -> float | None:
        if self._capture.get(cv2.CAP_PROP_AUTO_EXPOSURE) != _MANUAL_EXPOSURE:
            return None
        exposure = self._capture.get(cv2.CAP_PROP_EXPOSURE) * _EXPOSURE_UNIT
        return exposure if exposure > 0.0 else None

    def _sized(self, pixels: NDArray[np.uint8]) -> NDArray[np.uint8]:
        """Scale to the size of the robot file. Raises DeviceError where the shape differs.

        Scaling keeps the lens as it is, in parts of the picture. Cropping would not: focal length and middle of the
        robot file would be those of another picture, and everything that is measured by it wrong.
        """
        height, width = pixels.shape[:2]
        if (width, height) == (self._width, self._height):
            return pixels
        if abs(width * self._height - height * self._width) > max(width, height) / 2:  # half a pixel of the picture
            raise self._misfit(width, height, "of another shape")
        smaller = width > self._width
        size = self._width, self._height
        return np.asarray(
            cv2.resize(pixels, size, interpolation=cv2.INTER_AREA if smaller else cv2.INTER_LINEAR), np.uint8
        )

    def _misfit(self, width: int, height: int, how: str) -> DeviceError:
        what = f"{self._path}: it gives {width} x {height} px, {how} than {self._width} x {self._height}"
        remedy = "set width and height of its table in [robot.sensors]"
        return DeviceError(Trouble(what, remedy, "run", "giraff calibrate camera"))

    def _why_silent(self) -> Trouble:
        if not Path(self._path).exists():
            return Trouble(f"{self._path}: unplugged", "it is opened again when it is back")
        return Trouble(f"{self._path}: the camera gives no picture", "unplug it, and plug it in again")


def _pixels(header: Header, form: int) -> NDArray[np.uint8] | None:
    with muted_c_stderr():
        pixels = cv2.imdecode(np.frombuffer(header.data, np.uint8), form | cv2.IMREAD_IGNORE_ORIENTATION)
    return None if pixels is None else np.asarray(pixels, np.uint8)
