"""The speed control's arithmetic: on the base board's processor it gives what it gives on this machine, in time."""

import random
import struct
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, Final, NamedTuple

import cffi
import msgspec
import pytest

from giraff_schemas.boards import BASE_BOARD
from giraff_schemas.wire import SPEED_PERIOD_MS, STAMPS_PER_MS, ConfigureFrame, SpeedFlag
from giraff_sim.board import BUILD, Board
from tests.firmware.builds import FIRMWARE, HERE, built, shared_library
from tests.support.robots import BY_SPEED, ROBOT

PERIOD: Final = SPEED_PERIOD_MS * STAMPS_PER_MS
ROWS: Final = 1000
MILLISECOND_CYCLES: Final = 18_432
"""Of the board's processor: for the millisecond interrupt, for edges that interrupt it, and for the rest."""
MOST_CYCLES: Final = MILLISECOND_CYCLES // 2
ROW: Final = struct.Struct("<2i2H2HHH")  # struct speed_input
ANSWER: Final = struct.Struct("<2i2iBBH")  # struct answer of speed_rows.c
PLAIN: Final = BY_SPEED.board_settings(ROBOT, 1.2)


class Answer(NamedTuple):
    left_pwm_q8: int
    right_pwm_q8: int
    left_um_s: int
    right_um_s: int
    flags: int
    is_held: int


class Host:
    """The speed control, compiled for this machine."""

    def __init__(self, library: Path) -> None:
        ffi = cffi.FFI()
        ffi.cdef("bool rows_begin(const void *asked); void rows_step(const void *in, void *answer);")
        self._lib: Any = ffi.dlopen(str(library))
        self._answer = ffi.new("uint8_t[]", ANSWER.size)
        self._ffi = ffi

    def begin(self, settings: ConfigureFrame) -> bool:
        return bool(self._lib.rows_begin(settings.pack()))

    def step(self, row: bytes) -> Answer:
        self._lib.rows_step(row, self._answer)
        return Answer(*ANSWER.unpack(bytes(self._ffi.buffer(self._answer)))[:-1])


class Processor:
    """The same, in the base board's program on its processor."""

    SLICE_US: Final = 200

    def __init__(self, image: Path) -> None:
        self.board = Board(BASE_BOARD, BUILD / "lockstep" / "lockstep.so", image)
        self._now_us = 1000
        self.board.run(self._now_us)

    def begin(self, settings: ConfigureFrame) -> bool:
        return bool(self._ask(b"\0" + settings.pack(), 1)[0])

    def step(self, row: bytes) -> tuple[Answer, int]:
        """The answer, and the cycles it took."""
        *answer, cycles = ANSWER.unpack(self._ask(b"\1" + row, ANSWER.size))
        return Answer(*answer), cycles

    def _ask(self, asked: bytes, size: int) -> bytes:
        assert self.board.write(asked) == len(asked)
        answer = b""
        for _ in range(100):
            self._now_us += self.SLICE_US
            self.board.run(self._now_us)
            answer += self.board.read()
            if len(answer) >= size:
                break
        assert len(answer) == size
        return answer


class Wheel:
    """A motor of first order and its encoder, in integers."""

    def __init__(self, um_per_tick: int, strength: int) -> None:
        self.strength = strength
        """Per cent."""
        self.ticks = 65_500
        self.stamp = 0
        self.is_held = False
        self._um_per_tick = um_per_tick
        self._way = self.ticks * um_per_tick
        self._um_s = 0

    def move(self, now: int, pwm_q8: int, adc_counts: int) -> None:
        """Until `now`, the end of a period."""
        healthy_um_s = pwm_q8 * 600_000 // (70 * 256) * adc_counts // 800
        self._um_s += (healthy_um_s * self.strength // 100 - self._um_s) // 15
        if self.is_held:
            self._um_s = 0
        before = self._way
        self._way += self._um_s * SPEED_PERIOD_MS // 1000
        ticks = self._way // self._um_per_tick
        if ticks != self.ticks:
            edge = (ticks + (ticks < self.ticks)) * self._um_per_tick
            self.stamp = now - PERIOD + PERIOD * (edge - before) // (self._way - before)
            self.ticks = ticks


class Session(NamedTuple):
    settings: ConfigureFrame
    rows: list[bytes]
    answers: list[Answer]
    """What the host makes of the rows."""


def driven(
    chance: random.Random,
    host: Host,
    settings: ConfigureFrame,
    speeds: Sequence[int],
    count: int,
    *,
    strengths: tuple[int, int] = (85, 105),
    held: float = 0.15,
) -> Session:
    """The host closes its loop: speeds asked at random, a battery that sags, wheels that are held now and then."""
    session = Session(settings, [], [])
    per_km = settings.left_counts_per_km, settings.right_counts_per_km
    wheels = [Wheel(10**9 // counts, strength) for counts, strength in zip(per_km, strengths, strict=True)]
    asked, pwm_q8, adc_counts, now = (0, 0), (0, 0), 800, 65_000
    assert host.begin(settings)
    for number in range(count):
        if number % 25 == 0:
            asked = (chance.choice(speeds), chance.choice(speeds))
            for wheel in wheels:
                wheel.is_held = chance.random() < held
        adc_counts = max(550, min(1023, adc_counts + chance.randint(-8, 6)))
        now += PERIOD + chance.randint(-1, 1)
        for wheel, given in zip(wheels, pwm_q8, strict=True):
            wheel.move(now, given, adc_counts)
        shown = [wheel.ticks & 0xFFFF for wheel in wheels] + [wheel.stamp & 0xFFFF for wheel in wheels]
        session.rows.append(ROW.pack(*asked, *shown, now & 0xFFFF, adc_counts))
        answer = host.step(session.rows[-1])
        session.answers.append(answer)
        pwm_q8 = (answer.left_pwm_q8, answer.right_pwm_q8)
    return session


def wild(chance: random.Random, host: Host, settings: ConfigureFrame, count: int) -> Session:
    """Nothing that a robot does: whatever the wire and the registers can hold."""
    session = Session(settings, [], [])
    most = settings.speed_max_um_s
    assert host.begin(settings)
    for _ in range(count):
        asked = [chance.choice((most, -most, 0, chance.randint(-most, most))) for _ in range(2)]
        shown = [chance.choice((0, 0xFFFF, 0x8000, 0x7FFF, chance.getrandbits(16))) for _ in range(6)]
        session.rows.append(ROW.pack(*asked, *shown))
        session.answers.append(host.step(session.rows[-1]))
    return session


@pytest.fixture(scope="module")
def host(tmp_path_factory: pytest.TempPathFactory) -> Host:
    sources = (FIRMWARE / "base" / f"{name}.c" for name in ("speed", "speedometer", "held"))
    library = tmp_path_factory.mktemp("speed") / "speed.so"
    includes = (FIRMWARE / "common", FIRMWARE / "base")
    return Host(shared_library(library, HERE / "speed_rows.c", *sources, includes=includes))


@pytest.fixture(scope="module")
def processor(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Processor]:
    build = tmp_path_factory.mktemp("rows")
    built(build, HERE / "speed_rows.c", "avr-base")
    running = Processor(build / "firmware" / "base.elf")
    yield running
    running.board.close()


def sessions_on(host: Host) -> list[Session]:
    chance = random.Random(1)
    metre = 1_000_000
    fine_and_coarse = msgspec.structs.replace(
        PLAIN,
        left_counts_per_km=200_000_000,
        right_counts_per_km=50_000,
        speed_max_um_s=5 * metre,
        nominal_um_s=5 * metre,
        nominal_level=255,
        acceleration_um_s2=10 * metre,
        nominal_adc_counts=0,
        motor_ms=2000,
        pwm_max=255,
        stall_pwm=255,
        dead_pwm=0,
        speed_p=3900,
        speed_i=65_535,
        turn_p=3900,
        turn_i=65_535,
    )
    return [
        driven(chance, host, PLAIN, (0, 40_000, 150_000, 300_000, 600_000, -40_000, -300_000, -600_000), 250),
        driven(chance, host, PLAIN, (-600_000,), 250, strengths=(95, 62), held=0.0),
        driven(chance, host, fine_and_coarse, (0, 50_000, metre, -metre, 5 * metre, -5 * metre), 200),
        wild(chance, host, PLAIN, 150),
        wild(chance, host, fine_and_coarse, 150),
    ]


def test_the_processor_of_the_board_computes_what_a_host_computes_and_in_half_a_millisecond(
    host: Host, processor: Processor
) -> None:
    sessions = sessions_on(host)
    assert sum(len(session.rows) for session in sessions) == ROWS
    cycles: list[int] = []
    for session in sessions:
        assert processor.begin(session.settings)
        for row, expected in zip(session.rows, session.answers, strict=True):
            answer, took = processor.step(row)
            assert answer == expected, ROW.unpack(row)
            cycles.append(took)
    print(f"speed_step: {min(cycles)} to {max(cycles)} cycles, {sum(cycles) / ROWS:.0f} on average")
    assert max(cycles) < MOST_CYCLES, f"{max(cycles)} cycles, row {cycles.index(max(cycles))}"


def test_the_rows_tell_of_whatever_the_control_does(host: Host) -> None:
    answers = [answer for session in sessions_on(host) for answer in session.answers]
    flags = {bit for answer in answers for bit in SpeedFlag if answer.flags & bit}
    assert flags == set(SpeedFlag)
    assert {answer.is_held for answer in answers} == {0, 1}
    for pwm_q8 in ({a.left_pwm_q8 for a in answers}, {a.right_pwm_q8 for a in answers}):
        assert min(pwm_q8) < -30 * 256
        assert max(pwm_q8) > 60 * 256
        assert len(pwm_q8) > 300
