"""Drives before the simulated camera: pictures as the robot has them, true poses, and what the wheels say."""

import math
from collections.abc import Callable, Iterator
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from giraff_camera.jpeg import JpegEncoder
from giraff_core.kinematics.pose import Pose
from giraff_core.senses import Camera
from giraff_schemas.camera import Picture
from giraff_schemas.messages import Odometry, RobotTime
from giraff_sim.camera.renderer import Renderer
from giraff_sim.camera.scene import Scene
from giraff_sim.camera.solids import Solids
from giraff_sim.world.room import Pose as Place
from giraff_vision.policy import grey_of

CAMERA: Final = Camera(x=0.05, z=1.0, pitch=0.35)
"""The camera of deploy/robot.toml."""
RATE: Final = 15.0  # Hz
PATHS: Final = "straight", "weave", "square"
_STEP: Final = 0.01  # s between two samples of the wheels
_TICK: Final = 0.02  # s between two ticks of base
_LATE: Final = 4  # steps that a picture takes from its exposure to the service
_SPEED: Final = 0.4  # m/s
_TURNING: Final = math.radians(45.0)  # rad/s, on the spot
_RAMP: Final = 0.5  # m/s²
_TURN_RAMP: Final = 1.5  # rad/s²
_STANDS: Final = 30  # steps at the start and at the end


class Filmed(NamedTuple):
    """One picture of a drive."""

    time: float
    """s, of the exposure's middle."""
    pose: Pose
    """True pose at that time."""
    is_turning: bool
    """The robot turns on the spot."""
    wheels: Pose
    """What the wheels say at that time."""
    odometry: tuple[Odometry, ...]
    """Samples that come between the picture before and this one."""
    picture: Picture
    grey: NDArray[np.uint8]


def film(
    path: str,
    scene: Scene,
    way: float = 10.0,
    *,
    camera: Camera = CAMERA,
    scales: tuple[float, float] = (1.02, 1.03),
    grip: Callable[[float], float] = lambda _: 1.0,
    lean: Callable[[float], float] = lambda _: 0.0,
    solids: Solids | None = None,
    seed: int = 1,
) -> Iterator[Filmed]:
    """Drive `way` m. `scales`: of the wheels' way and turn; `grip`: share of both that the robot makes, at a time.

    `lean`: rad forward about an axle on the floor, at a time.
    """
    renderer, encoder, number = Renderer(camera, scene, solids, seed), JpegEncoder(80), 0
    true = wheels = Pose(0.0, 0.0, 0.0)
    travelled, heard, waiting = 0.0, list[Odometry](), list[tuple[int, Filmed]]()
    for step, (speed, turn) in enumerate(_twists(path, way)):
        time, share = step * _STEP, grip(step * _STEP)
        heard.append(_odometry(step, wheels, scales[0] * speed, scales[1] * turn, travelled))
        if (left := number / RATE - time) < _STEP:
            number += 1
            at = true.moved(share * speed * left, share * turn * left)
            place = Place(at.x, at.y, at.yaw)
            seen = renderer.frame(place, time + left, speed=share * speed, turn=share * turn, lean=lean(time))
            jpeg = encoder.encode(seen, 40_000)
            told = wheels.moved(scales[0] * speed * left, scales[1] * turn * left)
            is_turning = abs(turn) > 0.1 and abs(speed) < 0.01
            picture, grey = _picture(time + left, scene, camera, jpeg), grey_of(jpeg, camera)
            shot = Filmed(time + left, at, is_turning, told, (), picture, grey)
            waiting.append((step + _LATE, shot))
        if waiting and waiting[0][0] == step:
            yield waiting.pop(0)[1]._replace(odometry=tuple(heard))
            heard.clear()
        true = true.moved(share * speed * _STEP, share * turn * _STEP)
        wheels = wheels.moved(scales[0] * speed * _STEP, scales[1] * turn * _STEP)
        travelled += abs(scales[0] * speed * _STEP)


def _twists(path: str, way: float) -> Iterator[tuple[float, float]]:
    """Give m/s and rad/s of each step."""
    yield from [(0.0, 0.0)] * _STANDS
    sides = 4 if path == "square" else 1
    for side in range(sides):
        if side:
            yield from ((0.0, turn) for turn in _ramped(math.pi / 2, _TURNING, _TURN_RAMP))
        for step, speed in enumerate(_ramped(way / sides, _SPEED, _RAMP)):
            bend = 0.5 * math.sin(0.7 * step * _STEP) / _SPEED if path == "weave" else 0.0
            yield speed, bend * speed
    yield from [(0.0, 0.0)] * _STANDS


def _ramped(way: float, fastest: float, ramp: float) -> Iterator[float]:
    """Give the speeds of a way from standing to standing."""
    speed, left = 0.0, way
    while left > 1e-9:
        speed = min(speed + ramp * _STEP, fastest, math.sqrt(2.0 * ramp * left), left / _STEP)
        left -= speed * _STEP
        yield speed


def _odometry(step: int, wheels: Pose, speed: float, turn: float, path: float) -> Odometry:
    return Odometry(
        seq=step,
        instance="wheels",
        x=wheels.x,
        y=wheels.y,
        yaw=math.remainder(wheels.yaw, math.tau),
        linear_x=speed,
        angular_z=turn,
        covariance=(1e-6 * path, 0.0, 0.0, 1e-6 * path, 0.0, 1e-5 * path),
        path=path,
        board_us=round(step * _STEP * 1e6),
        boot_id=1,
        tick=RobotTime(1, round((1.0 + step * _STEP) * 1e9)),
    )


def _picture(middle: float, scene: Scene, camera: Camera, jpeg: bytes) -> Picture:
    begin = 1.0 + middle - scene.exposure / 2
    tick = math.floor(begin / _TICK) * _TICK
    return Picture(
        camera="head",
        seq=round(middle * RATE),
        instance="camera",
        jpeg=jpeg,
        width=camera.width,
        height=camera.height,
        tick=RobotTime(1, round(tick * 1e9)),
        exposure=scene.exposure,
        since_tick=begin - tick,
    )
