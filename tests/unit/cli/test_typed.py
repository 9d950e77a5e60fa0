"""Lengths, angles and patterns as they are typed: what is meant, and what is refused in a line with the way out."""

import math
from contextlib import suppress
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from giraff_cli.motion.pattern import PatternError, read_pattern
from giraff_cli.record.commands import bytes_of
from giraff_schemas.motion import Arc, Move, Turn
from giraff_tools.typed import angle, length, point, pose


@pytest.mark.parametrize(
    ("text", "rad"),
    [
        ("180deg", math.pi),
        ("180°", math.pi),
        ("180 deg", math.pi),
        ("-540deg", -3 * math.pi),
        ("+90deg", math.pi / 2),
        ("3.14", 3.14),
        ("-3.14", -3.14),
        (".5", 0.5),
        ("6.28", 6.28),
        ("3.14rad", 3.14),
        ("90rad", 90.0),
        ("pi", math.pi),
        ("π", math.pi),
        ("-pi", -math.pi),
        ("3pi", 3 * math.pi),
        ("3*pi", 3 * math.pi),
        ("0.5pi", math.pi / 2),
        ("pi/2", math.pi / 2),
        ("-3pi/4", -3 * math.pi / 4),
        ("pirad", math.pi),
        ("1e2deg", math.radians(100.0)),
        ("360/8deg", math.pi / 4),
        ("0", 0.0),
    ],
)
def test_an_angle_is_what_is_meant(text: str, rad: float) -> None:
    assert angle(text) == pytest.approx(rad)


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("90", "90 is more than a turn in radians: 90deg, or 90rad"),
        ("-180", "-180 is more than a turn in radians: -180deg, or -180rad"),
        ("6.3", "6.3 is more than a turn in radians"),
        ("90degrees", "'90degrees' is no angle: write it like 90deg, 1.57rad, pi/2 or -3pi"),
        ("pideg", "no angle"),
        ("nan", "no angle"),
        ("inf", "no angle"),
        ("", "no angle"),
        ("-", "no angle"),
        ("deg", "no angle"),
        ("/2", "no angle"),
        ("3*", "no angle"),
        ("1,5rad", "1,5rad has a comma: write 1.5rad"),
        ("pi/0", "no finite angle"),
        ("1e999deg", "no finite angle"),
        ("2m", "no angle"),
    ],
)
def test_what_is_no_angle_says_how_one_is_written(text: str, why: str) -> None:
    with pytest.raises(ValueError, match=r"angle|turn in radians|write") as told:
        angle(text)
    assert why in str(told.value)


@given(st.floats(-1e6, 1e6))
def test_degrees_and_radians_are_as_many(value: float) -> None:
    assert angle(f"{value!r}deg") == math.radians(value)
    assert angle(f"{value!r}rad") == value


@given(st.text(max_size=12))
def test_whatever_is_typed_is_a_finite_number_or_refused(text: str) -> None:
    for read in (angle, length):
        with suppress(ValueError):
            assert math.isfinite(read(text))
    with suppress(ValueError):
        assert all(map(math.isfinite, pose(text)))


def test_a_length_is_in_metres() -> None:
    assert [length(text) for text in ("2", "-0.5", "2m", " 1.5 m ", ".2")] == [2.0, -0.5, 2.0, 1.5, 0.2]
    for text in ("2cm", "2 mm", "nan", "inf", "1e999", "", "m", "two", "1,5,2"):
        with pytest.raises(ValueError, match=r"is no length: give metres, like 2 or -0\.5"):
            length(text)


@pytest.mark.parametrize(
    ("text", "size"),
    [
        ("4GB", 4 * 10**9),
        ("4GiB", 4 << 30),
        ("500MB", 5 * 10**8),
        ("0.5 gb", 5 * 10**8),
        ("100k", 100_000),
        ("2G", 2 * 10**9),
        ("1e6", 10**6),
        ("100000", 100_000),
    ],
)
def test_a_size_is_what_is_meant(text: str, size: int) -> None:
    assert bytes_of(text) == size


def test_a_point_is_two_lengths() -> None:
    assert [point(text) for text in ("2,1", "-0.5,2m", "1, -3")] == [(2.0, 1.0), (-0.5, 2.0), (1.0, -3.0)]
    for text in ("2", "2,", ",", "1;2", "1,2,3", "nan,1", "1,1e999", "kitchen"):
        with pytest.raises(ValueError, match=r"is no point: give x and y in metres, like 1\.5,-2"):
            point(text)


@pytest.mark.parametrize("text", ["1.5,-2.2,90deg", " 1.5 , -2.2m , 90°", "1.5,-2.2,-270deg", "1.5,-2.2,pi/2"])
def test_a_pose_is_a_point_and_an_angle_with_its_unit(text: str) -> None:
    x, y, yaw = pose(text)
    assert (x, y) == (1.5, -2.2)
    assert math.remainder(yaw - math.pi / 2, math.tau) == pytest.approx(0.0)


def test_what_is_no_pose_says_how_one_is_written() -> None:
    for text in ("", "1,2", "1,2,3,4", "1;2;3deg", "1,2,east", "1,,3deg", "nan,2,3deg", "1,2,inf", "1,2,"):
        with pytest.raises(ValueError, match=r"is no pose: give X,Y,YAW without a space, like 1\.5,-2,90deg"):
            pose(text)


def pattern(tmp_path: Path, text: str | bytes) -> Path:
    path = tmp_path / "pattern.toml"
    path.write_bytes(text.encode() if isinstance(text, str) else text)
    return path


def test_a_pattern_is_its_steps(tmp_path: Path) -> None:
    wish = read_pattern(
        pattern(
            tmp_path,
            '[[step]]\nmove = 2\n[[step]]\nturn = "pi"\n[[step]]\nturn = -1.5\n'
            '[[step]]\narc = {radius = 1.0, angle = "-90deg"}\n',
        )
    )
    assert wish.steps == (
        Move(distance=2.0),
        Turn(angle=math.pi),
        Turn(angle=-1.5),
        Arc(radius=1.0, angle=-math.pi / 2),
    )
    assert (wish.speed, wish.turn_speed, wish.time_limit) == (None, None, None)


BAD = (
    ("", "it has no [[step]]; one has move = 2.0"),
    ("step = 3", "step must be a list, and is a number"),
    ("[[step]]\nmove 2", "no TOML: "),
    ("[[step]]\nmove = 2\nmove = 3", "no TOML: "),
    ("[[step]]\n", "step 1: it has nothing: give one of move = 2.0"),
    ("[[step]]\nmove = 1\n[[step]]\nmove = 2\nturn = 1", "step 2: it has move and turn: give one of"),
    ("[[step]]\nmov = 2", "unknown field `mov` in step 1"),
    ("sped = 0.3\n[[step]]\nmove = 2", "unknown field `sped`"),
    ('[[step]]\nmove = "2m"', "step 1, move must be a number or none, and is text"),
    ("[[step]]\nmove = true", "step 1, move must be a number or none, and is true or false"),
    ("[[step]]\nmove = 0", "step 1: a move of 0 m goes nowhere"),
    ("[[step]]\nmove = nan", "step 1: distance is nan, not a finite number"),
    ("[[step]]\nmove = inf", "step 1: distance is inf, not a finite number"),
    ("[[step]]\nturn = 90", "step 1: 90 is more than a turn in radians: 90deg, or 90rad"),
    ("[[step]]\nturn = nan", "step 1: 'nan' is no angle"),
    ('[[step]]\nturn = "0deg"', "step 1: a turn of 0 turns nothing"),
    ('[[step]]\nturn = "right"', "step 1: 'right' is no angle"),
    ("[[step]]\narc = {radius = 1.0}", "`angle` is missing in step 1, arc"),
    ("[[step]]\narc = {radius = 0.0, angle = 1}", "step 1: a radius of 0 m is none"),
    ("[[step]]\narc = {radius = nan, angle = 1}", "step 1: radius is nan"),
    ("[[step]]\narc = {radius = 1.0, angle = 0}", "step 1: an arc of 0 goes nowhere"),
    ("[[step]]\ngo_to = [1.0]", "step 1, go_to must have 2 values, and has 1"),
    ("[[step]]\ngo_to = [1.0, nan]", "step 1: y is nan"),
    ('[[step]]\ngo_to = [1.0, 2.0]\nframe = "mop"', "step 1, frame cannot be 'mop'"),
    ('[[step]]\nmove = 1\nframe = "map"', "step 1: it has a frame, map, and no go_to"),
    ("speed = 0\n[[step]]\nmove = 2", "speed is 0: give a positive number"),
    ("turn_speed = -1\n[[step]]\nmove = 2", "turn_speed is -1: give a positive number"),
    ("time_limit = inf\n[[step]]\nmove = 2", "time_limit is inf: give a positive number"),
    (b"\xff\xfe", "it is no text"),
    (b"# " + b"x" * 1_000_001, "over 1000000 bytes"),
    ("x = " + "[" * 5000, "pattern.toml: "),
)


@pytest.mark.parametrize(("text", "why"), BAD, ids=[repr(text[:40]) for text, _ in BAD])
def test_what_is_no_pattern_is_told_in_a_line(tmp_path: Path, text: str | bytes, why: str) -> None:
    with pytest.raises(PatternError) as told:
        read_pattern(pattern(tmp_path, text))
    assert why in str(told.value)
    assert "\n" not in str(told.value)


def test_what_is_no_file_is_told_in_a_line(tmp_path: Path) -> None:
    for path, why in ((tmp_path, "Is a directory"), (tmp_path / "none.toml", "No such file or directory")):
        with pytest.raises(PatternError, match=why):
            read_pattern(path)
