"""JPEGs that no camera sends, made of the segments of one that any camera may send."""

import struct

import cv2
import numpy as np
from numpy.typing import NDArray

START, END = b"\xff\xd8", b"\xff\xd9"
FRAMES = {"baseline": 0xC0, "progressive": 0xC2}


def segment(code: int, body: bytes) -> bytes:
    return struct.pack(">BBH", 0xFF, code, len(body) + 2) + body


def frame(code: int, width: int, height: int, components: int = 1) -> bytes:
    """Return the segment that names the size."""
    return segment(code, struct.pack(">BHHB", 8, height, width, components) + bytes(3 * components))


def scan(components: int = 1) -> bytes:
    return segment(0xDA, bytes([components]) + bytes(2 * components + 3))


def jpeg_of(pixels: NDArray[np.uint8], kind: str = "baseline") -> bytes:
    return cv2.imencode(".jpg", pixels, [cv2.IMWRITE_JPEG_PROGRESSIVE, int(kind == "progressive")])[1].tobytes()


def bomb(kind: str, width: int = 32_000, height: int = 32_000) -> bytes:
    """Return some hundred bytes for which a decoder takes gigabytes."""
    small = jpeg_of(np.full((16, 16), 128, np.uint8), kind)
    at = small.index(bytes([0xFF, FRAMES[kind]])) + 5
    return small[:at] + struct.pack(">HH", height, width) + small[at + 4 :]


def before_tables(jpeg: bytes, put: bytes) -> bytes:
    """Return the JPEG with other bytes behind its first segment."""
    at = jpeg.index(b"\xff\xdb")
    return jpeg[:at] + put + jpeg[at:]
