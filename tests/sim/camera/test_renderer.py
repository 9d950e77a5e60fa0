"""The simulated camera's pictures, held to projections that are worked out here."""

import math
from functools import lru_cache
from typing import Any

import msgspec
import numpy as np
import pytest
from numpy.typing import NDArray

from giraff_core.senses import Camera
from giraff_sim.camera.lens import rays, resized
from giraff_sim.camera.renderer import Renderer
from giraff_sim.camera.scene import Board, Lens, Scene, Shadow, Sheet, Walker
from giraff_sim.camera.solids import Solids
from giraff_sim.camera.textures import FLOORS, Floor
from giraff_sim.world.room import Pose

CAMERA = Camera(x=0.05, z=1.0, pitch=0.35, distortion=(-0.1, 0.03, 0.002, -0.001, 0.0))
PLAIN = Scene(floor="lino", noise=0.0, gradient=0.0)
ORIGIN = Pose(0.0, 0.0, 0.0)


def pixel(camera: Camera, x: float, y: float, z: float) -> tuple[float, float]:
    """Column and row of a point before a robot at the origin. `camera` has neither roll nor yaw."""
    ahead, left, up = x - camera.x, y - camera.y, z - camera.z
    cos, sin = math.cos(camera.pitch), math.sin(camera.pitch)
    depth = ahead * cos - up * sin
    u, v = -left / depth, -(ahead * sin + up * cos) / depth
    k1, k2, p1, p2, k3 = camera.distortion
    square = u * u + v * v
    radial = 1.0 + k1 * square + k2 * square**2 + k3 * square**3
    bent_u = u * radial + 2.0 * p1 * u * v + p2 * (square + 2.0 * u * u)
    bent_v = v * radial + p1 * (square + 2.0 * v * v) + 2.0 * p2 * u * v
    return (camera.width - 1) / 2 + camera.focal_x * bent_u, (camera.height - 1) / 2 + camera.focal_y * bent_v


@lru_cache
def renderer_of(camera: Camera, scene: Scene) -> Renderer:
    """Without noise, all its pictures of one room are the same."""
    assert not scene.noise
    return Renderer(camera, scene)


def rgb(scene: Scene, solids: Solids | None = None, camera: Camera = CAMERA, **more: Any) -> NDArray[np.int64]:
    renderer = renderer_of(camera, scene)
    renderer.solids = solids or Solids()
    return renderer.frame(ORIGIN, **more).astype(np.int64)


def edges(line: NDArray[np.int64], least: int = 30) -> list[float]:
    """Between which pixels of a line the colour changes."""
    return [float(place) + 0.5 for place in np.flatnonzero(np.abs(np.diff(line, axis=0)).sum(axis=1) > least)]


@pytest.mark.parametrize("size", [(320, 240), (200, 150)])
def test_a_box_lands_where_its_corners_must(size: tuple[int, int]) -> None:
    camera = resized(CAMERA, *size)
    box = [("box", 2.0, 0.4, 2.0, -0.3), ("box", 2.0, -0.3, 2.6, -0.3), ("box", 2.6, -0.3, 2.6, 0.4)]
    shown = rgb(PLAIN, Solids([*box, ("box", 2.6, 0.4, 2.0, 0.4)]), camera)
    for z in (0.05, 0.2, 0.35):  # its front ends to the left and to the right
        (left, row), (right, right_row) = pixel(camera, 2.0, 0.4, z), pixel(camera, 2.0, -0.3, z)
        line = shown[round((row + right_row) / 2)]
        found = edges(line)
        assert min(abs(place - left) for place in found) < 1.0
        assert min(abs(place - right) for place in found) < 1.0
    foot, front, back = (pixel(camera, *at) for at in ((2.0, 0.05, 0.0), (2.0, 0.05, 0.4), (2.6, 0.05, 0.4)))
    found = edges(shown[:, round(foot[0])], least=8)
    for _, row in (foot, front, back):  # below, before and behind its top
        assert min(abs(place - row) for place in found) < 1.0


def test_the_nearest_is_seen_and_what_is_higher_behind_it() -> None:
    near, far = ("box", 1.5, 1.0, 1.5, -1.0), ("cupboard", 3.0, 1.0, 3.0, -1.0)
    alone = rgb(PLAIN, Solids([far]))
    both = rgb(PLAIN, Solids([far, near]))
    column, row = (round(value) for value in pixel(CAMERA, 1.5, 0.0, 0.3))
    behind = round(pixel(CAMERA, 3.0, 0.0, 1.2)[1])
    assert (both[row, column] != alone[row, column]).any()
    assert (both[behind] == alone[behind]).all()
    below = round(pixel(CAMERA, 1.2, 0.0, 0.0)[1])
    assert (both[below:, column] == rgb(PLAIN)[below:, column]).all()  # the floor before it


def test_a_wall_that_is_touched_fills_the_picture() -> None:
    wall = rgb(PLAIN, Solids([("room", 0.09, 5.0, 0.09, -5.0)]), msgspec.structs.replace(CAMERA, pitch=0.0))
    assert (np.abs(wall - rgb(PLAIN, camera=msgspec.structs.replace(CAMERA, pitch=0.0))).sum(axis=2) > 10).all()


def test_a_person_stands_on_the_floor_and_walks() -> None:
    walker = Walker((2.0, 0.5), (2.0, -0.5), speed=1.0)
    floor, first, later = (
        rgb(PLAIN),
        rgb(PLAIN._replace(people=(walker,))),
        rgb(PLAIN._replace(people=(walker,)), t=1.0),
    )
    for shown, y in ((first, 0.5), (later, -0.5)):
        place = np.flatnonzero((np.abs(shown - floor).sum(axis=2) > 40).sum(axis=0))
        assert place.mean() == pytest.approx(pixel(CAMERA, 2.0, y, 0.8)[0], abs=4.0)
    named = Solids([("person", 1.9, 0.5, 2.1, 0.5)], [("another person", 2.0, -0.5, 0.2)])
    waiting = tuple(Walker((2.0, y), (2.0, y), speed=0.0) for y in (0.5, -0.5))
    assert (rgb(PLAIN, named) == rgb(PLAIN._replace(people=waiting))).all()


@pytest.mark.parametrize("floor", [floor for floor in FLOORS if floor != "bare"])
def test_the_far_floor_does_not_sparkle(floor: Floor) -> None:
    """A step of 1 cm moves the floor at 6 m by less than a pixel: there it must look nearly the same."""
    renderer = renderer_of(CAMERA, PLAIN._replace(floor=floor))
    renderer.solids = Solids()
    one, other = (renderer.frame(Pose(x, 0.0, 0.0)).astype(float).mean(axis=2) for x in (0.0, 0.01))
    far, near = (slice(0, round(pixel(CAMERA, x, 0.0, 0.0)[1])) for x in (6.0, 1.5))
    assert np.abs(one - other)[far].max() < 8.0
    detail = np.abs(np.diff(one, axis=1))
    assert detail[far].mean() < detail[near.stop :].mean()


def test_a_leaning_robot_looks_from_where_the_mast_then_is() -> None:
    lean, pivot = 0.1, 0.15
    above = CAMERA.z - pivot
    x, z = (
        CAMERA.x * math.cos(lean) + above * math.sin(lean),
        pivot + above * math.cos(lean) - CAMERA.x * math.sin(lean),
    )
    level = msgspec.structs.replace(CAMERA, x=x, z=z, pitch=CAMERA.pitch + lean)
    walls = Solids([("room", 3.0, 2.0, 3.0, -2.0), ("shelf", 2.0, 1.0, 2.0, 0.2)])
    assert np.abs(rgb(PLAIN, walls, lean=lean, pivot=pivot) - rgb(PLAIN, walls, level)).mean() < 0.2


def test_a_seed_and_the_same_calls_give_the_same_pictures() -> None:
    one, other = (Renderer(CAMERA, Scene(floor="lino")) for _ in range(2))
    frames = [[renderer.frame(ORIGIN, speed=0.5).tobytes() for _ in range(2)] for renderer in (one, other)]
    assert frames[0] == frames[1]
    assert frames[0][0] != frames[0][1]  # the noise


def test_a_shadow_moves_over_the_floor() -> None:
    scene = PLAIN._replace(shadow=Shadow())
    assert (rgb(scene) - rgb(scene, t=3.0) > 20).any()
    assert (rgb(scene) == rgb(scene, t=12.0)).all()


def test_dirt_and_a_hand_stay_in_the_picture_and_lamps_switch() -> None:
    bare = PLAIN._replace(floor="bare")
    dirty, covered = bare._replace(lens=Lens(specks=40, print=0.12)), bare._replace(lens=Lens(covered=0.6))
    clean, there = rgb(bare), Pose(0.3, 0.1, 0.2)
    assert (renderer_of(CAMERA, bare).frame(there) == clean).all()  # it has nothing to see
    assert (renderer_of(CAMERA, dirty).frame(there) == rgb(dirty)).all()
    assert 500 < (clean - rgb(dirty) > 30).any(axis=2).sum() < 5000
    hand = (clean != rgb(covered)).any(axis=2)
    assert hand[:, :192].all()
    assert not hand[:, 192:].any()
    assert (rgb(bare._replace(light=3.0)) == 255).mean() > 0.9
    lamps = bare._replace(switching=2.0)
    assert [round(rgb(lamps, t=t).mean() / clean.mean(), 1) for t in (0.5, 1.5, 2.5)] == [1.0, 0.5, 1.0]


def test_motion_blurs_where_it_exceeds_a_pixel() -> None:
    scene = PLAIN._replace(floor="gravel")
    still = np.abs(np.diff(rgb(scene), axis=0)).mean()
    for speed, is_blurred in ((0.1, False), (0.8, True)):
        assert (np.abs(np.diff(rgb(scene, speed=speed), axis=0)).mean() < 0.95 * still) == is_blurred


def test_paper_lies_where_its_corners_must() -> None:
    sheet = rgb(PLAIN._replace(sheet=Sheet(1.4, 0.1))).mean(axis=2) - rgb(PLAIN).mean(axis=2)
    place = np.argwhere(sheet > 30)
    corners = [pixel(CAMERA, 1.4 + dx, 0.1 + dy, 0.0) for dx in (-0.1485, 0.1485) for dy in (-0.105, 0.105)]
    for axis, values in ((1, [u for u, _ in corners]), (0, [v for _, v in corners])):
        assert (place[:, axis].min(), place[:, axis].max()) == pytest.approx((min(values), max(values)), abs=1.0)
    board = Board((1.0, 0.2, 1.0), (0.0, -1.0, 0.0), (0.0, 0.0, -1.0), 8, 6, 0.04)
    shown = rgb(PLAIN._replace(board=board)).mean(axis=2)
    for column in (1, 4):
        u, v = (round(value) for value in pixel(CAMERA, 1.0, 0.2 - (column + 0.5) * 0.04, 1.0 - 2.5 * 0.04))
        assert (shown[v, u] < 80.0) == (column % 2 == 0)


def test_a_ray_is_where_its_pixel_is() -> None:
    camera = msgspec.structs.replace(CAMERA, x=0.0, z=0.02, pitch=0.0, center_x=150.0)
    found = rays(camera)
    for column, row in ((0, 0), (319, 239), (150, 119), (20, 200)):
        right, down, _ = found[row, column]
        u, v = pixel(camera, 1.0, -right, camera.z - down)
        assert (u + 150.0 - 159.5, v) == pytest.approx((column, row), abs=1e-6)
