"""How fast the base board takes a wheel to turn, from its edges alone."""

import math
import random
from typing import Any

import cffi
import pytest

from giraff_schemas.wire import OVERDUE_INTERVALS, OVERDUE_MS, SPEED_PERIOD_MS, STAMPS_PER_MS
from tests.firmware.builds import FIRMWARE, shared_library

BASE = FIRMWARE / "base"
UM_PER_TICK = 499.486
WRAP = 0x10000


class Speedometer:
    """speedometer.c, and the time and edges that it is told of."""

    def __init__(self, ffi: cffi.FFI, library: Any, *, stamp: int = 0, ticks: int = 0) -> None:
        self._ffi, self._library = ffi, library
        self.inside: Any = ffi.new("struct speedometer *")
        self.ticks = ticks
        self.stamp = self.now = stamp

    def step(self, edges: list[int] | None = None, late: int = 0) -> int:
        """A period with `edges`, each forward (1) or backward (-1), the newest `late` stamps before its end: um/s."""
        self.now = (self.now + SPEED_PERIOD_MS * STAMPS_PER_MS) % WRAP
        for edge in edges or []:
            self.ticks = (self.ticks + edge) % WRAP
            self.stamp = (self.now - late) % WRAP
        um_per_tick_q8 = round(UM_PER_TICK * 256)
        self._library.speedometer_step(self.inside, um_per_tick_q8, self.ticks, self.stamp, self.now)
        return int(self.inside.um_s)

    def turn(self, speed: float, milliseconds: int) -> list[int]:
        """A wheel that turns evenly, m/s: what it is taken for in each period."""
        per_stamp = speed * 1e3 / STAMPS_PER_MS / UM_PER_TICK
        seen: list[int] = []
        for period in range(milliseconds // SPEED_PERIOD_MS):
            stamps = SPEED_PERIOD_MS * STAMPS_PER_MS
            before, after = (math.floor(abs(per_stamp) * stamps * number) for number in (period, period + 1))
            late = stamps * (period + 1) - math.ceil(after / abs(per_stamp)) if after > before else 0
            seen.append(self.step([1 if speed > 0 else -1] * (after - before), late))
        return seen


@pytest.fixture(scope="module")
def compiled(tmp_path_factory: pytest.TempPathFactory) -> tuple[cffi.FFI, Any]:
    library = tmp_path_factory.mktemp("speedometer") / "speedometer.so"
    ffi = cffi.FFI()
    header = (BASE / "speedometer.h").read_text().splitlines()
    ffi.cdef("\n".join(line for line in header if not line.startswith("#")))
    return ffi, ffi.dlopen(str(shared_library(library, BASE / "speedometer.c", includes=[FIRMWARE / "common"])))


@pytest.fixture
def meter(compiled: tuple[cffi.FFI, Any]) -> Speedometer:
    return Speedometer(*compiled)


@pytest.mark.parametrize("speed", [0.02, 0.05, 0.1, 0.3, 0.6, -0.05, -0.6, 5.0])
@pytest.mark.parametrize("start", [0, WRAP - 3000])
def test_it_tells_an_even_speed(compiled: tuple[cffi.FFI, Any], speed: float, start: int) -> None:
    """Over the wraps of ticks and stamps, too."""
    meter = Speedometer(*compiled, stamp=start, ticks=start)
    for told in meter.turn(speed, 2000)[30:]:
        assert told == pytest.approx(speed * 1e6, rel=0.02)
    assert not meter.inside.is_overdue


def test_a_wheel_that_is_pushed_off_at_once_has_a_speed(meter: Speedometer) -> None:
    """With edges in each period from the first on."""
    for _ in range(20):
        meter.step()
    assert meter.turn(0.3, 200)[-1] == pytest.approx(300_000, rel=0.02)
    assert not meter.inside.is_overdue


def test_an_edge_that_comes_while_the_time_is_read_is_not_an_old_one(meter: Speedometer) -> None:
    """The encoders' interrupts come between the two: the newest edge is a little younger than the time."""
    meter.turn(0.3, 200)
    assert meter.step([1, 1, 1, 1, 1], late=-2) > 0
    assert meter.inside.silent == 0
    assert not meter.inside.is_overdue


@pytest.mark.parametrize(
    ("edges", "periods", "overdue_ms"),
    [
        (3, 1, OVERDUE_MS),
        (1, 1, OVERDUE_MS),
        (1, 2, OVERDUE_INTERVALS * 20),
        (1, 3, OVERDUE_INTERVALS * 30),
        (1, 5, 100),
    ],
)
def test_an_edge_is_overdue_after_three_intervals_and_30_ms(
    meter: Speedometer, edges: int, periods: int, overdue_ms: int
) -> None:
    """And after 100 ms in any case."""
    for _ in range(10):
        for _ in range(periods - 1):
            meter.step()
        meter.step([1] * edges)
    silent_ms = 0
    assert not meter.inside.is_overdue
    while not meter.inside.is_overdue:
        meter.step()
        silent_ms += SPEED_PERIOD_MS
    assert silent_ms == overdue_ms + SPEED_PERIOD_MS


def test_two_edges_close_to_each_other_are_no_speed(meter: Speedometer) -> None:
    """It trembles, or has just begun to turn."""
    for _ in range(20):
        meter.step()
    meter.step([1], late=0)
    assert 0 < meter.step([1], late=SPEED_PERIOD_MS * STAMPS_PER_MS - 1) <= 2 * UM_PER_TICK / SPEED_PERIOD_MS * 1e3


def test_without_an_edge_it_gets_slower_and_stands(meter: Speedometer) -> None:
    meter.turn(0.3, 300)
    for number in range(1, 10):
        assert meter.step() <= UM_PER_TICK / number / SPEED_PERIOD_MS * 1e3 + 1
    meter.step()
    assert meter.step() == 0
    for _ in range(300):
        meter.step()
        assert (meter.inside.is_overdue, meter.inside.um_s) == (True, 0), "however often the stamps wrap"


@pytest.mark.parametrize("seed", range(5))
def test_a_wheel_that_trembles_stands(meter: Speedometer, seed: int) -> None:
    chance = random.Random(seed)
    at = 0
    for number in range(300):
        edges: list[int] = []
        for _ in range(chance.randrange(4)):
            edges.append(-1 if at else 1)
            at += edges[-1]
        meter.step(edges, chance.randrange(700))
        if number > 10:
            assert meter.inside.is_overdue
            assert abs(meter.inside.um_s) <= 2 * UM_PER_TICK / SPEED_PERIOD_MS * 1e3


def test_a_wheel_that_turns_round_is_taken_for_no_faster_than_it_is(meter: Speedometer) -> None:
    meter.turn(0.4, 400)
    for told in meter.turn(-0.4, 40):
        assert abs(told) <= 420_000
    assert meter.turn(-0.4, 100)[-1] == pytest.approx(-400_000, rel=0.03)
