"""A picture as the fits take it."""

import cv2
import numpy as np
from numpy.typing import NDArray

from giraff_core.picture.header import HeaderError, read_picture
from giraff_node.process.c_library import muted_c_stderr

Grey = NDArray[np.uint8]
"""(height, width), 0 black to 255 white."""
Points = NDArray[np.float64]
"""(n, 2) px: x to the right, y down, from the middle of the left upper pixel."""


class UnusableError(Exception):
    """This picture, or all of them, cannot be used. The message says why and what to do."""


def decode(data: bytes, width: int, height: int) -> Grey:
    """Return the grey picture of a JPEG or PNG, as the sensor saw it. Raises UnusableError.

    `width`, `height`: of the camera, px. A picture of another size is refused before it is decoded.
    """
    try:
        header = read_picture(data)
    except HeaderError as error:
        raise UnusableError(f"it is no picture that can be read: {error}; give JPEG or PNG") from error
    if header[:2] != (width, height):
        raise UnusableError(
            f"the picture is {header.width} x {header.height} px, and the robot file says {width} x {height}; take "
            "full pictures, over a better link, or correct the robot file"
        )
    try:
        with muted_c_stderr():
            pixels = cv2.imdecode(
                np.frombuffer(header.data, np.uint8), cv2.IMREAD_GRAYSCALE | cv2.IMREAD_IGNORE_ORIENTATION
            )
    except cv2.error:
        pixels = None
    if pixels is None:
        raise UnusableError("it is no picture that can be read; give JPEG or PNG")
    grey = np.asarray(pixels, np.uint8)
    if header.is_cut(grey[header.last_block].tobytes()):
        raise UnusableError("the picture is torn: its end is missing")
    return grey
