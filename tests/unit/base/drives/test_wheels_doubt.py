"""One wheel against the other: an encoder that slips is found within half a second, and no sound robot is doubted."""

import itertools
import math
import random
from collections.abc import Callable

import msgspec
import pytest

from giraff_base.drives.wheels.config import WheelsConfig
from giraff_base.drives.wheels.doubt import WheelDoubt
from giraff_core.kinematics.differential_drive import CREEP
from giraff_schemas.wire import WheelsFrame
from tests.support.robots import BY_SPEED, DRIVE
from tests.unit.base.rig import Board, Rig, demand

PER_SPEED = 70 / 0.6
"""PWM counts for each m/s."""
SOUND = tuple(itertools.product((0.82, 1.0), (0.82, 1.0), (-0.077, 0.0, 0.077), (0.0, 0.015)))
"""Gain of each wheel, offset of both by a slope of 3 degrees, and of the left one by a carpet, m/s."""
Pair = tuple[float, float]


def watched(
    powers: Callable[[float], Pair],
    speeds: Callable[[float], Pair],
    seconds: float,
    *,
    lost: int = 0,
    drive: WheelsConfig = BY_SPEED,
) -> WheelDoubt:
    """Return the doubt after so many seconds of reports, each with the power and the speed told at its time.

    `lost`: the first reports of each 0.9 s, which do not come.
    """
    doubt, report = WheelDoubt(drive), Board().report()
    for step in range(round(seconds * 100)):
        if step % 90 < lost:
            continue
        (left_pwm, right_pwm), (left, right) = powers(step / 100), speeds(step / 100)
        doubt.on_report(
            msgspec.structs.replace(
                report,
                board_us=(0xFFFFFFFF - 500_000 + step * 10_000) & 0xFFFFFFFF,
                left_pwm_counts=round(left_pwm),
                right_pwm_counts=round(right_pwm),
                left_um_s=round(left * 1e6),
                right_um_s=round(right * 1e6),
            )
        )
    return doubt


@pytest.mark.parametrize(("speed", "seconds"), [(0.2, 1.2), (0.4, 0.5), (-0.6, 0.5)])
@pytest.mark.parametrize("slope", [-0.077, 0.0, 0.077])
@pytest.mark.parametrize(("wheel", "name"), [(0, "left"), (1, "right")])
def test_a_wheel_that_half_slips_is_named_soon(
    speed: float, seconds: float, slope: float, wheel: int, name: str
) -> None:
    sign = 1.0 if speed > 0.0 else -1.0
    powers = [sign * (abs(speed) + slope) * PER_SPEED for _ in range(2)]
    powers[wheel] = sign * (2.0 * abs(speed) + slope) * PER_SPEED
    held = watched(lambda _: (powers[0], powers[1]), lambda _: (speed, speed), seconds)  # the board holds what is told
    assert f" {name} wheel" in held.trouble.what
    held.forget()
    assert not held.trouble


@pytest.mark.parametrize(("seconds", "pause", "is_doubted"), [(0.2, 0.0, False), (0.3, 1.0, False), (0.3, 0.2, True)])
def test_an_edge_below_one_wheel_is_no_fault(seconds: float, pause: float, *, is_doubted: bool) -> None:
    """It takes twice the power for a moment; whether a second one follows at once or after a `pause`."""
    length = seconds + pause
    tries = 2 if pause else 1

    def at(t: float, hard: Pair, easy: Pair) -> Pair:
        if t < tries * length and t % length < seconds:
            return hard
        return (0.0, 0.0) if pause else easy

    even = 0.4 * PER_SPEED
    doubt = watched(
        lambda t: at(t, (2.0 * even, even), (even, even)), lambda t: at(t, (0.4, 0.4), (0.4, 0.4)), tries * length + 1.0
    )
    assert bool(doubt.trouble) == is_doubted


@pytest.mark.parametrize("stops", [False, True])
def test_lost_reports_and_stops_hide_no_slip(*, stops: bool) -> None:
    def when_driving(pair: Pair) -> Callable[[float], Pair]:
        return lambda t: (0.0, 0.0) if stops and t % 0.9 < 0.2 else pair

    powers = when_driving((0.8 * PER_SPEED, 0.4 * PER_SPEED))
    assert "left wheel" in watched(powers, when_driving((0.4, 0.4)), 2.5, lost=7).trouble.what


@pytest.mark.parametrize("speed", [0.2, 0.4, 0.6])
def test_levels_that_one_wheel_counts_half_are_doubted_too(speed: float) -> None:
    power = speed * PER_SPEED
    assert "left wheel" in watched(lambda _: (power, power), lambda _: (speed / 2.0, speed), 2.0).trouble.what


@pytest.mark.parametrize(("left", "right", "slope", "carpet"), SOUND)
def test_no_sound_robot_is_doubted(left: float, right: float, slope: float, carpet: float) -> None:
    """Whatever it is asked for: curves, turns in place, starts and stops, up and down a slope."""
    chance = random.Random(f"{left}/{right}/{slope}/{carpet}")
    told: list[Pair] = [(0.0, 0.0)]
    given: list[Pair] = [(0.0, 0.0)]
    yaw = 0.0
    for _ in range(20):
        asked = chance.uniform(-0.6, 0.6), chance.uniform(-0.6, 0.6)
        asked = asked if chance.random() < 0.5 else (asked[0], asked[0])
        for _ in range(chance.randrange(20, 250)):
            power, speed = [], []
            yaw += (told[-1][1] - told[-1][0]) / 0.47 * 0.01
            uphill = slope * math.cos(yaw)
            for wheel, (gain, offset) in enumerate(((left, uphill + carpet), (right, uphill))):
                before = told[-1][wheel]
                now = before + min(0.012, max(-0.029, asked[wheel] - before))
                speed.append(now)
                power.append((now + (now - before) * 15.0 + offset) / gain * PER_SPEED)
            told.append((speed[0], speed[1]))
            given.append((power[0], power[1]))
    doubt = watched(lambda t: given[round(t * 100)], lambda t: told[round(t * 100)], len(told) / 100)
    assert not doubt.trouble


@pytest.mark.parametrize(("drive", "most"), [(DRIVE, 0.6), (BY_SPEED, 0.4)], ids=["level", "speed"])
def test_a_board_that_holds_speeds_without_its_volts_is_asked_for_two_thirds(drive: WheelsConfig, most: float) -> None:
    """Both encoders may lose counts alike: only the power bounds the speed then."""
    for volts in (0.0, 0.03):
        rig = Rig(drive=msgspec.structs.replace(drive, battery_volts_per_count=volts))
        rig.arm()
        rig.tilt(0.6)
        rig.run(1.5)
        fastest = demand(rig.sent[-1].frame)[0] / (1e6 if drive.asks_for_speeds else PER_SPEED)
        slowed = not volts and drive.asks_for_speeds
        assert fastest == pytest.approx(most if slowed else 0.6)
        notice = str(rig.base.faults["wheels"])
        assert ("battery_volts_per_count is not known; measure" in notice) == slowed
        assert str(rig.base.state().reason) == (f"slowed: {notice}" if slowed else "")


class Slipping(Board):
    """Its left encoder loses half of its counts."""

    def report(self) -> WheelsFrame:
        report = super().report()
        return msgspec.structs.replace(report, left_um_s=report.left_um_s // 2, left_ticks=report.left_ticks // 2)


@pytest.mark.parametrize("drive", [DRIVE, BY_SPEED], ids=["level", "speed"])
def test_a_slipping_encoder_slows_the_robot_to_creep_until_the_port_is_opened_anew(drive: WheelsConfig) -> None:
    rig = Rig(drive=drive)
    rig.board = Slipping(board_us=0xFFFFFFFF - 2_000_000)
    rig.arm()
    rig.tilt(0.5)
    rig.run(0.3)
    assert not rig.base.faults["wheels"]
    rig.run(2.0)
    fault = rig.base.faults["wheels"]
    assert "encoder or motor of the left wheel" in fault.what
    assert fault.remedy
    assert str(rig.base.state().reason) == str(fault.of("slowed"))
    most = CREEP / 3.0 * 1e6 if drive.asks_for_speeds else CREEP / 1.5 * PER_SPEED
    for _ in range(2):  # also after a pause
        assert demand(rig.sent[-1].frame) == (round(most), round(most))
        rig.tilt(0.0)
        rig.run(1.0)
        assert str(rig.base.state().reason) == ""
        assert rig.base.faults["wheels"]
        rig.tilt(0.5)
        rig.run(1.0)
    rig.base.on_link_opened(session=7)
    assert not rig.base.faults["wheels"]
