"""What the policy tells of filmed drives, judged by the true motion."""

import math
from collections.abc import Callable, Iterable
from functools import cache
from itertools import islice

import cv2
import msgspec
import numpy as np
import pytest
from numpy.typing import NDArray

from giraff_core.kinematics.pose import Pose
from giraff_core.senses import Camera
from giraff_schemas.camera import VisualOdometry
from giraff_schemas.messages import RobotTime
from giraff_schemas.trouble import Trouble
from giraff_sim.camera import textures
from giraff_sim.camera.scene import Lens, Scene, Shadow
from giraff_sim.camera.textures import Floor
from giraff_vision import reasons
from giraff_vision.ground import Ground, PictureError
from giraff_vision.policy import VisionPolicy
from giraff_vision.rigid_motion import Consensus, refined
from tests.support.filmed_drive import CAMERA, Filmed, film

Grey = NDArray[np.uint8]
ALIKE = 991  # seed of no other floor: floors are kept by their seeds
Told = list[tuple[Filmed, VisualOdometry, Pose]]
"""Each picture, what is told of it, and the true motion since its key picture."""


def told_of(shots: Iterable[Filmed], camera: Camera = CAMERA) -> Told:
    policy, found, key = VisionPolicy(camera), Told(), (-1, Pose(0.0, 0.0, 0.0))
    last = key[1]
    for shot in shots:
        for odometry in shot.odometry:
            policy.on_odometry(odometry)
        told = policy.on_picture(shot.picture, shot.grey)
        key = key if told.key == key[0] else (told.key, last)
        found.append((shot, told, shot.pose.seen_from(key[1])))
        last = shot.pose
    return found


def is_right(told: VisualOdometry, true: Pose) -> bool:
    """Whether the motion since the key picture is within a fifth, or within a centimetre."""
    assert told.motion is not None
    off = math.dist(told.motion[:2], true[:2])
    return off < max(0.2 * math.hypot(*true[:2]), 0.01) and abs(told.motion[2] - true.yaw) < 0.01


@cache
def clear() -> tuple[Filmed, ...]:
    """Return 24 pictures that end on the move."""
    return tuple(islice(film("straight", Scene("carpet")), 24))


@cache
def dirty() -> tuple[Filmed, ...]:
    """Return 24 pictures through a dirty lens over a floor that shows nothing."""
    return tuple(islice(film("straight", Scene("bare", lens=Lens(specks=100))), 24))


@pytest.mark.parametrize(("floor", "path", "pictures"), [("planks", "weave", 40), ("carpet", "square", 68)])
def test_a_path_is_measured(floor: Floor, path: str, pictures: int) -> None:
    (first, *_), *_, (last, end, _) = found = told_of(islice(film(path, Scene(floor), 0.8), pictures))
    assert [told.reason for _, told, _ in found[1:] if told.reason] == []
    off = Pose(*end.path).seen_from(last.pose.seen_from(first.pose))
    assert math.hypot(off.x, off.y) < 0.01 * end.seen_m
    assert abs(off.yaw) < math.radians(2.0)
    assert end.blind_m == 0.0


def slipping(grip: float) -> Iterable[Filmed]:
    """Return a drive in which the robot makes a share of the wheels' way for a while."""
    return islice(film("straight", Scene("carpet"), grip=lambda time: grip if 0.8 < time < 1.4 else 1.0), 28)


@pytest.mark.parametrize(
    "shots",
    [lambda: slipping(0.0), lambda: slipping(0.7), dirty],
    ids=["wheels spin", "wheels slip", "dirty lens"],
)
def test_a_disagreement_tells_both_motions_and_is_no_measurement(shots: Callable[[], Iterable[Filmed]]) -> None:
    found = told_of(shots())
    assert all(is_right(told, true) for _, told, true in found if told.is_measured)
    apart = [(told.motion, told.wheels, true) for _, told, true in found if str(told.reason) == str(reasons.DISAGREE)]
    assert apart
    for motion, wheels, true in apart:
        assert motion is not None
        assert wheels is not None
        assert min(abs(motion[0] - true.x), abs(wheels[0] / 1.02 - true.x)) < 0.01  # one of the two is right


@pytest.mark.parametrize(("floor", "pictures"), [("lino", 12), ("planks", 28)])
def test_a_shadow_that_moves_is_no_motion(floor: Floor, pictures: int) -> None:
    shadow = Shadow(0.0, middle=1.7, swing=1.0, period=3.0, half_width=0.2, light=0.2)
    found = told_of(islice(film("straight", Scene(floor, shadow=shadow), 1.0), pictures))
    assert all(is_right(told, true) for _, told, true in found if told.is_measured)
    reasons_told = {told.reason for _, told, _ in found}
    assert {reasons.UNSURE, reasons.MOVING} <= reasons_told


@pytest.mark.parametrize("broken", ["origin", "epoch", "gap"])
def test_wheels_that_tell_nothing_of_the_way_since_the_key_picture_keep_their_veto(broken: str) -> None:
    shots = [*dirty()]
    for number in range(12, len(shots)):
        heard = shots[number].odometry
        if broken == "origin":
            heard = tuple(msgspec.structs.replace(each, jumps=1) for each in heard)
        if broken == "gap":
            heard = () if number < 20 else heard
        if broken == "epoch":
            heard = tuple(msgspec.structs.replace(each, tick=RobotTime(2, each.tick.robot_ns)) for each in heard)
            picture = msgspec.structs.replace(shots[number].picture, tick=RobotTime(2, _ns(shots[number])))
            shots[number] = shots[number]._replace(picture=picture)
        shots[number] = shots[number]._replace(odometry=heard)
    found = told_of(shots)[12:]
    assert any(told.wheels is None for _, told, _ in found)
    assert sum(told.is_measured and not is_right(told, true) for _, told, true in found) <= 2
    assert str(found[-1][1].reason) == str(reasons.DISAGREE)


def test_a_turn_on_the_spot_behind_a_dirty_lens_is_contradicted_by_the_wheels() -> None:
    shots = list(islice(film("square", Scene("bare", lens=Lens(specks=100)), 0.04), 24))
    turning = [told for shot, told, _ in told_of(shots) if shot.is_turning]
    assert len(turning) > 10
    assert all(told.reason for told in turning[1:])


def test_a_body_that_sways_is_followed() -> None:
    sway = film("straight", Scene("carpet"), 1.0, lean=lambda time: math.radians(2.0) * math.sin(math.tau * 2.0 * time))
    found = told_of(islice(sway, 20))
    assert all(told.is_measured for _, told, _ in found[1:])
    assert all(is_right(told, true) for _, told, true in found[1:])


def test_corners_in_one_place_tell_no_motion() -> None:
    ground, floor = Ground(CAMERA, 320, 240), np.tile([[1.2, 0.0]], (8, 1))
    pixels = ground.seen(floor, np.zeros((1, 5)))[0]
    assert refined(ground, floor, pixels, Consensus(np.zeros(5), np.full(8, True), 0), np.zeros(2)) is None


@pytest.mark.parametrize(("share", "is_told"), [(0.7, True), (1.0, False)])
def test_a_lean_that_puts_the_lens_on_the_floor_tells_no_motion(share: float, is_told: bool) -> None:
    """No picture can be warped to that floor."""
    ground = Ground(Camera(x=0.5, z=0.1, pitch=0.35), 320, 240)
    floor = np.array([[x, y] for x in (0.8, 1.0, 1.3, 1.7) for y in (-0.3, -0.1, 0.1, 0.3)])
    motion = np.array([0.0, 0.0, 0.0, 0.0, 0.2 * share])
    pixels = ground.seen(floor, motion[None])[0]
    fit = refined(ground, floor, pixels, Consensus(motion, np.full(len(floor), True), 0), motion[3:])
    assert (fit is not None) == is_told


def test_a_lens_that_bends_is_straightened() -> None:
    camera = msgspec.structs.replace(CAMERA, distortion=(-0.3, 0.1, 0.0, 0.0, 0.0), yaw=0.6, roll=0.2, y=0.2)
    (first, *_), *_, (last, told, _) = told_of(islice(film("straight", Scene("carpet"), camera=camera), 20), camera)
    off = Pose(*told.path).seen_from(last.pose.seen_from(first.pose))
    assert math.hypot(off.x, off.y) < 0.01 * told.seen_m


@pytest.mark.parametrize("since_tick", [-1.0, 1e300, 20.0])
def test_a_picture_of_an_impossible_moment_is_refused(since_tick: float) -> None:
    shot = clear()[0]
    with pytest.raises(PictureError, match="which no camera does"):
        VisionPolicy(CAMERA).on_picture(msgspec.structs.replace(shot.picture, since_tick=since_tick), shot.grey)


@pytest.mark.parametrize(("off", "then"), [(0.005, ""), (0.03, str(reasons.DOUBTED))])
def test_a_large_difference_is_remembered_until_both_have_agreed_over_some_way(off: float, then: str) -> None:
    shots = [*clear()]
    shoved = [msgspec.structs.replace(each, x=each.x + off) for each in shots[2].odometry]
    shots[2] = shots[2]._replace(odometry=tuple(shoved))
    told = [str(each.reason) for _, each, _ in told_of(shots)]
    assert told[1:4] == ["", str(reasons.DISAGREE), then]
    assert told[-1] == ""


def test_a_robot_file_of_another_lens_ends_nothing() -> None:
    assert len(told_of(clear()[:8], msgspec.structs.replace(CAMERA, focal_x=700.0, focal_y=700.0))) == 8


@pytest.mark.parametrize(("width", "height"), [(160, 120), (320, 200)])
def test_a_picture_that_does_not_fit_the_robot_file_is_refused(width: int, height: int) -> None:
    with pytest.raises(PictureError, match=f"have 320 by 240 px, and the camera of the robot file {width} by {height}"):
        told_of(clear()[:1], msgspec.structs.replace(CAMERA, width=width, height=height))


def _ns(shot: Filmed) -> int:
    assert shot.picture.tick is not None
    return shot.picture.tick.robot_ns


def half_still(grey: Grey) -> Grey:
    return np.hstack([clear()[20].grey[:, :160], grey[:, 160:]])


UNUSABLE: dict[str, tuple[Trouble, Callable[[], Iterable[Filmed]]]] = {
    "dark": (reasons.DARK, lambda: begun(Scene("carpet", light=0.04))),
    "over-exposed": (reasons.OVEREXPOSED, lambda: begun(Scene("carpet", light=3.0))),
    "covered": (reasons.COVERED, lambda: begun(Scene("carpet", lens=Lens(covered=0.6)))),
    "featureless": (reasons.FEATURELESS, lambda: begun(Scene("bare"))),
    "blurred": (reasons.BLURRED, lambda: changed(lambda grey: cv2.GaussianBlur(grey, (0, 0), 8.0))),
    "another picture": (reasons.LOST, lambda: (*clear()[:16], *changed(np.fliplr))),
    "moving": (reasons.MOVING, lambda: changed(half_still)),
}


def begun(scene: Scene) -> Iterable[Filmed]:
    return islice(film("straight", scene), 2)


def changed(change: Callable[[Grey], object]) -> Iterable[Filmed]:
    """Return the last clear pictures with a change of the very last."""
    return (*clear()[16:23], clear()[23]._replace(grey=np.asarray(change(clear()[23].grey), np.uint8)))


@pytest.mark.parametrize("case", UNUSABLE)
def test_a_picture_that_tells_nothing_says_why(case: str) -> None:
    reason, shots = UNUSABLE[case]
    *_, (_, told, _) = told_of(shots())
    assert (told.reason, told.motion) == (reason, None)


def test_a_camera_that_looks_up_sees_no_floor() -> None:
    (_, told, _), *_ = told_of(clear()[:1], msgspec.structs.replace(CAMERA, pitch=-0.6))
    assert str(told.reason) == str(reasons.NO_FLOOR)


def test_a_pattern_that_repeats_is_unsure_where_no_wheels_contradict(monkeypatch: pytest.MonkeyPatch) -> None:
    """Tiles of 0.128 m that are all alike: pictures alone go wrong there, later, by the shadow."""
    assert [told.reason for _, told, _ in told_of(deaf(clear()[12:]))[1:] if told.reason] == []
    y, x = np.mgrid[0 : textures.SIZE, 0 : textures.SIZE]
    tiles = np.where((x % 32 < 2) | (y % 32 < 2), 85.0, 130.0)
    monkeypatch.setattr(textures, "_floor", lambda _, chance: tiles + chance.normal(0.0, 4.0, tiles.shape))
    kept = textures._levels
    monkeypatch.setattr(textures, "_levels", lambda name, seed: kept(name, seed if name == "tiles" else 1))
    scene = Scene("tiles", shadow=Shadow(period=6.0))
    shots = list(islice(film("straight", scene, 4.0, seed=ALIKE), 12))
    alone = told_of(deaf(shots))
    assert {str(told.reason) for _, told, _ in alone[1:]} == {str(reasons.UNSURE)}
    assert not any(told.is_measured or any(told.covariance) for _, told, _ in alone)
    assert all(told.is_measured and is_right(told, true) for _, told, true in told_of(shots)[1:])


def deaf(shots: Iterable[Filmed]) -> list[Filmed]:
    """Return the pictures without the wheels' word."""
    return [shot._replace(odometry=()) for shot in shots]
