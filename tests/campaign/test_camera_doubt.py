"""No sound wheels are doubted by a camera, on good floors and in scenes that may deceive it; half counts are."""

from collections.abc import Iterable
from typing import Final

import msgspec
import pytest

from giraff_base.drives.wheels.camera_doubt import CameraDoubt
from giraff_core.senses import Camera
from giraff_schemas.messages import Wheels
from giraff_sim.camera.scene import Scene
from giraff_sim.camera.textures import Floor
from giraff_vision.policy import VisionPolicy
from tests.support.filmed_drive import CAMERA, PATHS, Filmed, film
from tests.support.vision_figures import BAD, TEXTURED, calibrated

_COUNTS: Final = 2000.0  # a metre
_SCALES: Final = (0.97, 0.97), (1.02, 1.03)


def is_doubted(filmed: Iterable[Filmed], cameras: Iterable[Camera]) -> bool:
    """Whether any of the cameras makes base doubt the wheels of a drive."""
    pairs = [(VisionPolicy(camera), CameraDoubt(_COUNTS)) for camera in cameras]
    for number, shot in enumerate(filmed):
        for policy, doubt in pairs:
            for odometry in shot.odometry:
                policy.on_odometry(odometry)
                doubt.on_wheels(_wheels(odometry.path, odometry.linear_x, odometry.board_us, odometry.tick))
            told = msgspec.structs.replace(policy.on_picture(shot.picture, shot.grey), seq=number)
            doubt.on_camera(told, shot.odometry[-1].tick)
    return any(bool(doubt.trouble) for _, doubt in pairs)


def _wheels(path: float, speed: float, board_us: int, tick: object) -> Wheels:
    count = round(path * _COUNTS)
    return msgspec.convert(
        {
            **dict.fromkeys(("left_ticks", "right_ticks"), count),
            **dict.fromkeys(("left_velocity", "right_velocity"), speed),
            **dict.fromkeys(("left_pwm_counts", "right_pwm_counts"), 50),
            "board_us": board_us,
            "boot_id": 1,
            "tick": tick,
        },
        Wheels,
        from_attributes=True,
    )


@pytest.mark.parametrize("scales", _SCALES)
@pytest.mark.parametrize("path", PATHS)
@pytest.mark.parametrize("floor", TEXTURED)
def test_on_good_floors(floor: Floor, path: str, scales: tuple[float, float]) -> None:
    cameras = (CAMERA, *calibrated().values())
    assert not is_doubted(film(path, Scene(floor), 6.0, scales=scales), cameras)
    assert is_doubted(film(path, Scene(floor), 3.0, scales=(0.5, 0.5)), [CAMERA])


@pytest.mark.parametrize("path", ["straight", "weave"])
@pytest.mark.parametrize("name", BAD)
def test_in_bad_scenes(name: str, path: str) -> None:
    assert not is_doubted(film(path, BAD[name], 4.0, scales=_SCALES[0]), [CAMERA])
