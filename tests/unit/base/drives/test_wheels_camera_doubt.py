"""Wheels against a camera: encoders that lose counts alike are found within 1.5 s, and no sound ones are."""

import itertools
from collections.abc import Callable
from typing import Any

import pytest
from msgspec.structs import replace

from giraff_base.drives.wheels.camera_doubt import CameraDoubt
from giraff_base.drives.wheels.config import WheelsConfig
from giraff_core.kinematics.differential_drive import CREEP
from giraff_schemas.camera import VisualOdometry
from giraff_schemas.messages import RobotTime, Wheels
from tests.support.robots import BY_SPEED, DRIVE
from tests.unit.base.rig import EPOCH, STEP_NS, Rig, demand

COUNTS = 2000.0
"""A metre."""
LATE = 6
"""Reports from a picture to its word."""
SURE = (1e-6, 0.0, 0.0, 1e-6, 0.0, 1e-6)
UNSURE = (0.0,) * 6
Change = Callable[[VisualOdometry], VisualOdometry]


def same(told: VisualOdometry) -> VisualOdometry:
    return told


def moment(step: int) -> RobotTime:
    return RobotTime(EPOCH, 10_000_000_000 + step * STEP_NS)


class Camera:
    """Sees each 7th report's way, and says so `LATE` reports later, as giraff_vision does."""

    def __init__(self, change: Change = same) -> None:
        self._change = change
        self._told: list[tuple[int, VisualOdometry]] = []
        self._numbers, self._key, self._key_way = itertools.count(), 0, 0.0

    def look(self, step: int, way: float, tick: RobotTime) -> list[VisualOdometry]:
        """Return what comes now. `way`: m that the robot has truly gone."""
        if step % 7 == 0:
            number, gone = next(self._numbers), way - self._key_way
            told = VisualOdometry(
                seq=number,
                instance="vision",
                camera="head",
                picture=number,
                tick=tick,
                key=self._key,
                motion=(gone, 0.0, 0.0),
                covariance=SURE,
                path=(0.0, 0.0, 0.0),
            )
            self._told.append((step + LATE, self._change(told)))
            if abs(gone) > 0.25:
                self._key, self._key_way = self._key + 1, way
        return [self._told.pop(0)[1]] if self._told and self._told[0][0] == step else []


def watched(
    change: Change = same,
    speed: Callable[[float], float] = lambda _: 0.6,
    counted: float = 0.5,
    seconds: float = 4.0,
    report: Callable[[int, Wheels], Wheels] = lambda _, wheels: wheels,
    power: int = 50,
) -> CameraDoubt:
    """Return the doubt after a drive. `counted`: share of the true way that both encoders count."""
    doubt, camera, way = CameraDoubt(COUNTS), Camera(change), 0.0
    for step in range(round(seconds * 100)):
        fast = speed(step / 100)
        way += fast / 100
        count, now = round(way * counted * COUNTS) & 0xFFFFFFFF, moment(step)
        wheels = Wheels(
            left_ticks=count,
            right_ticks=count,
            left_velocity=fast * counted,
            right_velocity=fast * counted,
            left_pwm_counts=power,
            right_pwm_counts=power,
            board_us=step * 10_000,
            boot_id=1,
            tick=now,
        )
        wheels = report(step, wheels)
        doubt.on_wheels(wheels)
        for told in camera.look(step, way, wheels.tick):
            doubt.on_camera(told, wheels.tick)
    return doubt


def at(which: Callable[[int], bool], change: Change) -> Change:
    """Change those pictures alone, by their number."""
    return lambda told: change(told) if which(told.picture) else told


def moved(by: float) -> Change:
    """Have a picture say so many m more."""
    return lambda told: replace(told, motion=((told.motion or (0.0,))[0] + by, 0.0, 0.0))


def earlier(seconds: float) -> Change:
    """Have a picture say that it was taken so much earlier; it may be later."""
    return lambda told: replace(
        told, tick=told.tick and replace(told.tick, robot_ns=told.tick.robot_ns - round(seconds * 1e9))
    )


def short_pauses(step: int, wheels: Wheels) -> Wheels:
    return replace(wheels, left_pwm_counts=0, right_pwm_counts=0) if step % 90 < 20 else wheels


def ramp(t: float) -> float:
    return min(0.6, max(0.0, t - 1.0) * 0.6)


def fro(t: float) -> float:
    return 0.4 if t % 2.0 < 1.0 else -0.4


SOUND = {
    "as the camera": {"counted": 1.0},
    "a tenth less, as where the camera is told too high": {"counted": 0.9},
    "to and fro": {"counted": 1.0, "speed": fro},
    "more: wheels that spin, a dirty lens": {"counted": 2.0},
    "a start, told 0.12 s too early": {"counted": 0.87, "speed": ramp, "change": earlier(0.12)},
    "a camera that is not precise": {
        "counted": 1.0,
        "change": at(lambda n: n > 30, lambda told: replace(moved(0.06)(told), covariance=(0.001, *SURE[1:]))),
    },
    "pictures that lie, two in a row": {"counted": 1.0, "change": at(lambda n: n in (31, 32, 34, 35), moved(5.0))},
    "none, while somebody carries it": {"counted": 0.0, "power": 0},
    "pictures that name one moment": {
        "counted": 1.0,
        "change": at(lambda n: n > 30, lambda told: replace(told, tick=moment(210))),
    },
    "a camera that slides aside in turns": {
        "counted": 0.0,
        "speed": lambda _: 0.0,
        "change": lambda told: replace(told, motion=(0.0, told.picture / 70, 0.0)),
    },
}


@pytest.mark.parametrize(("speed", "counted"), [(0.2, 0.66), (0.3, 0.5), (-0.6, 0.5)])
def test_counts_lost_by_both_are_found_soon(speed: float, counted: float) -> None:
    found = watched(speed=lambda _: speed, counted=counted, seconds=1.5)
    assert "encoders of both wheels" in found.trouble.what
    assert "restart giraff_base" in found.trouble.remedy
    assert watched(speed=lambda t: speed if t < 1.5 else 0.0, counted=counted).trouble, "it lasts"
    assert watched(report=short_pauses, seconds=2.0).trouble, "nor hidden by short pauses"
    another = at(lambda n: n % 10 == 9, lambda told: replace(told, instance="another"))
    assert watched(another).trouble, "nor by a second giraff_vision"
    found.forget()
    assert not found.trouble


@pytest.mark.parametrize("drive", SOUND.values(), ids=SOUND.keys())
def test_no_sound_wheels_are_doubted(drive: dict[str, Any]) -> None:
    assert not watched(**drive).trouble


LEFT_OUT: dict[str, Change] = {
    "not sure": lambda told: replace(told, covariance=UNSURE),
    "no motion": lambda told: replace(told, motion=None),
    "of another base": lambda told: replace(told, tick=RobotTime(EPOCH + 1, told.tick.robot_ns if told.tick else 0)),
    "no tick": lambda told: replace(told, tick=None),
    "old": earlier(0.5),
    "of the future": earlier(-0.2),
    "before its tick": lambda told: replace(told, since_tick=-0.01),
    "long after its tick": lambda told: replace(earlier(0.6)(told), since_tick=0.6),
    "never": lambda told: replace(told, since_tick=1e300),
    "the same moment again": lambda told: replace(told, tick=moment(35)),
    "the key picture's word was lost": lambda told: replace(told, seq=told.seq + told.key),
    "a key picture was lost": lambda told: replace(told, key=2 * told.key),
    "the key picture is not sure": lambda told: (
        replace(told, covariance=UNSURE) if told.motion and told.motion[0] > 0.25 else told
    ),
}


@pytest.mark.parametrize("change", LEFT_OUT.values(), ids=LEFT_OUT.keys())
def test_pictures_that_cannot_be_compared_are_left_out(change: Change) -> None:
    assert not watched(change).trouble


def test_the_next_giraff_vision_begins_a_new_window() -> None:
    """It counts a second after the last word of the one before, and its way from there on."""
    later = at(lambda n: n > 11, lambda told: replace(told, instance="later"))
    assert not watched(later, speed=lambda _: 0.12, seconds=2.6).trouble
    assert watched(later, speed=lambda _: 0.12, seconds=5.0).trouble


@pytest.mark.parametrize(
    "report",
    [
        lambda step, wheels: replace(wheels, boot_id=step // 80),
        lambda step, wheels: replace(wheels, tick=moment(step - 50 * (step // 80))),
    ],
    ids=["board", "clock"],
)
def test_a_board_or_a_clock_that_begins_anew_begins_a_new_window(report: Callable[[int, Wheels], Wheels]) -> None:
    assert not watched(report=report).trouble


@pytest.mark.parametrize("number", [1e308, -1e308, 5e-324])
def test_no_number_ends_base(number: float) -> None:
    watched(
        at(lambda n: n % 5 == 0, lambda told: replace(told, motion=(number, number, number), covariance=(number,) * 6))
    )


@pytest.mark.parametrize("drive", [DRIVE, BY_SPEED], ids=["level", "speed"])
def test_the_robot_creeps_until_the_port_is_opened_anew(drive: WheelsConfig) -> None:
    rig, camera, steps = Rig(drive=drive), Camera(), itertools.count()

    def run(seconds: float) -> None:
        for step in itertools.islice(steps, round(seconds * 100)):
            rig.step()
            way = 2.0 * (rig.samples[-1].left_ticks if rig.samples else 0) / COUNTS
            for told in camera.look(step, way, rig.now):
                rig.base.on_camera(told, rig.now)

    rig.arm()
    rig.tilt(0.5)
    run(0.8)
    assert not rig.base.faults["wheels"]
    run(1.5)
    fault = rig.base.faults["wheels"]
    assert "encoders of both wheels" in fault.what
    assert str(rig.base.state().reason) == str(fault.of("slowed"))
    most = round(CREEP / 3.0 * 1e6 if drive.asks_for_speeds else CREEP / 1.5 * 70 / 0.6)
    assert demand(rig.sent[-1].frame) == (most, most)
    rig.base.on_link_opened(session=7)
    assert not rig.base.faults["wheels"]
