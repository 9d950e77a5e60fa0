"""The library OpenCV with one thread, and with no wait that never ends. This package imports `cv2` from here alone."""

from __future__ import annotations

import os

# Read when the library is loaded. s without a picture after which V4L2 gives up; the default is 10.
os.environ.setdefault("OPENCV_VIDEOIO_V4L_SELECT_TIMEOUT", "2")

import cv2 as cv2  # noqa: PLC0414  after the setting; the name is given to others

# A picture of 320 x 240 takes 1 ms. More threads would take the processor from the services that drive.
cv2.setNumThreads(1)
