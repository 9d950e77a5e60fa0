"""A picture's size is read as a decoder would read it, before there is a decoder."""

import struct

import pytest

from giraff_core.picture.header import HeaderError, read_jpeg, read_picture
from tests.support.jpegs import END, START, frame, scan, segment

FRAME, SCAN, DATA = frame(0xC0, 320, 240), scan(), b"\x12\xff\x00\x34\x00\xff\x00"
WHOLE = START + FRAME + SCAN + DATA + END
OTHER = START + frame(0xC0, 9, 9) + SCAN + DATA + END
PNG = b"\x89PNG\r\n\x1a\n"


def ihdr(width: int, height: int) -> bytes:
    return struct.pack(">I4sII5x", 13, b"IHDR", width, height)


@pytest.mark.parametrize(
    "data",
    [
        *(START + frame(code, 320, 240) + SCAN + DATA + END for code in (*range(0xC0, 0xC4), *range(0xC5, 0xC8))),
        *(START + frame(code, 320, 240) + SCAN + DATA + END for code in (*range(0xC9, 0xCC), *range(0xCD, 0xD0))),
        START + b"\xff\xff\xff" + FRAME + b"\xff" + SCAN + DATA + END,
        START + b"\xff\x00ab" + FRAME + SCAN + DATA + END,
        START + b"\xff\xd0\xff\x01" + FRAME + SCAN + DATA + END,
        START + segment(0xE1, b"Exif\0\0" + OTHER) + FRAME + SCAN + DATA + END,
        START + segment(0xFE, frame(0xC0, 9, 9)) + FRAME + SCAN + DATA + END,
        START + b"".join(segment(code, frame(0xC0, 9, 9)) for code in (0xC4, 0xC8, 0xCC, 0xDC)) + WHOLE[2:],
        START + segment(0xE1, bytes(60_000)) * 500 + WHOLE[2:],
        START + FRAME + segment(0xDB, END) + SCAN + DATA + END,
    ],
)
def test_the_size_of_a_jpeg_is_that_of_its_frame(data: bytes) -> None:
    header = read_jpeg(data)
    assert header[:2] == (320, 240)
    assert (header.data, header.is_ended) == (data, True)


@pytest.mark.parametrize("tail", [b"\xff", b"\r\n", bytes(40), OTHER, b"ftypmp42"])
def test_bytes_behind_the_end_are_no_part_of_it(tail: bytes) -> None:
    assert read_jpeg(WHOLE + tail) == read_jpeg(WHOLE)


@pytest.mark.parametrize("tail", [b"", bytes(40)])
def test_a_missing_end_is_added_once(tail: bytes) -> None:
    header = read_jpeg(WHOLE[:-2] + tail)
    assert (header.data, header.is_ended) == (WHOLE, False)


def test_filling_in_the_last_block_tells_a_jpeg_that_is_cut() -> None:
    whole = read_jpeg(START + frame(0xC0, 321, 250) + SCAN + DATA + END)
    cut = read_jpeg(START + frame(0xC0, 321, 250) + SCAN + DATA)
    assert cut.last_block == (slice(248, None), slice(320, None))
    assert cut.is_cut(b"\x80" * 6)
    assert not cut.is_cut(b"\x80" * 5 + b"\x81")
    assert not whole.is_cut(b"\x80" * 6)


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (b"", "no JPEG"),
        (b"\n" + WHOLE, "no JPEG"),
        (START, "no JPEG"),
        (b"GIF89a", "no JPEG"),
        (START + FRAME[:9], "header is damaged"),
        (START + FRAME + SCAN[:5], "header is damaged"),
        (START + b"\xff" * 100_000, "header is damaged"),
        (START + FRAME + END, "header is damaged"),
        (START + WHOLE, "header is damaged"),
        (START + SCAN + FRAME + DATA + END, "header is damaged"),
        (START + segment(0xC0, b"\x08") + SCAN + DATA + END, "header is damaged"),
        (START + b"\xff\xe0\0\1" + WHOLE[2:], "header is damaged"),
        (START + segment(0xFE, b"") * 1000 + WHOLE[2:], "header is damaged"),
        (START + FRAME + frame(0xC0, 9, 9) + SCAN + DATA + END, "two sizes"),
        (START + frame(0xC0, 320, 0) + SCAN + DATA + segment(0xDC, b"\0\1") + END, "no size"),
        (START + frame(0xC0, 0, 240) + SCAN + DATA + END, "no size"),
        (START + frame(0xC2, 320, 240) + (SCAN + DATA) * 65 + END, "65 scans"),
        (START + frame(0xC2, 320, 240) + SCAN + DATA, "torn"),
        (START + FRAME + SCAN + DATA + SCAN + DATA, "torn"),
        (START + frame(0xC0, 320, 240, 3) + SCAN + DATA, "torn"),
    ],
)
def test_what_cannot_be_judged_is_refused(data: bytes, words: str) -> None:
    with pytest.raises(HeaderError, match=words):
        read_jpeg(data)


def test_the_size_of_a_png_is_that_of_its_first_chunk() -> None:
    data = PNG + ihdr(320, 240) + b"the rest"
    assert read_picture(data) == (320, 240, data, True)
    assert read_picture(WHOLE) == read_jpeg(WHOLE)
    with pytest.raises(HeaderError, match="no JPEG"):
        read_jpeg(data)
    for bad in (PNG, PNG + ihdr(320, 240)[:14], PNG + ihdr(320, 240).replace(b"IHDR", b"tEXt"), PNG + ihdr(0, 9)):
        with pytest.raises(HeaderError, match="header is damaged"):
            read_picture(bad)


@pytest.mark.parametrize(
    ("size", "camera", "fits"),
    [
        ((160, 120), (320, 240), True),
        ((1280, 960), (320, 240), True),
        ((1281, 240), (320, 240), False),
        ((320, 961), (320, 240), False),
        ((4608, 3456), (1920, 1080), True),
        ((7680, 4320), (1920, 1080), False),
        ((1920, 1080), (1920, 1080), True),
    ],
)
def test_a_picture_is_at_most_16_megapixels_and_four_times_the_camera(
    size: tuple[int, int], camera: tuple[int, int], fits: bool
) -> None:
    assert read_jpeg(START + frame(0xC0, *size) + SCAN + DATA + END).fits(*camera) == fits
