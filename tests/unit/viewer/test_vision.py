"""Visual odometry on the screen, without one."""

import math
from typing import Any

import msgspec
import pytest
import rerun as rr

from giraff_schemas import topics
from giraff_schemas.camera import Picture
from giraff_schemas.trouble import Trouble
from giraff_viewer.rows import Row
from giraff_viewer.scene import Scene, stock
from tests.unit.cli.samples import MS, at, odometry, seen

SECOND = 1_000_000_000
SEEN = msgspec.structs.replace(
    seen(SECOND + 10 * MS, 0.0),
    instance="v1",
    width=160,
    height=120,
    tracked=((79, 59), (0, 0)),
    rejected=((10, 20),),
    ground=((0, 40), (159, 40), (159, 119)),
)


def look_at(scene: Scene, now_ns: int, **changes: Any) -> list[Row]:
    return scene.on_sample(topics.VISUAL_ODOM, msgspec.structs.replace(SEEN, **changes), now_ns)


def points_of(archetype: Any) -> list[list[float]]:
    return [list(point) for point in archetype.positions.as_arrow_array().to_pylist()]


def test_its_path_is_drawn_from_where_the_robot_was_and_the_wheels_word_is_dimmer() -> None:
    scene = Scene(stock("sim"))
    assert look_at(scene, SECOND) == [], "odometry has not begun"
    scene.on_sample(topics.ODOM, odometry(SECOND, 1.0, 2.0, math.pi / 2.0), SECOND)
    scene.on_sample(topics.ODOM, odometry(SECOND + 100 * MS, 1.0, 2.04, math.pi / 2.0), SECOND)
    frame = dict(look_at(scene, SECOND, path=(3.0, 0.0, 0.0)))["frames/visual_path"]
    assert frame.parent_frame.as_arrow_array().to_pylist() == ["odom"]
    assert frame.translation.as_arrow_array().to_pylist()[0] == pytest.approx([1.0, -1.0, 0.0])
    for step, blind_m in enumerate((0.0, 0.1, 0.2, 0.2), start=1):
        assert look_at(scene, SECOND, path=(3.0 + 0.1 * step, 0.0, 0.0), blind_m=blind_m) == []
    path = dict(scene.update(2 * SECOND))["floor/visual"]
    strips = [[x for x, _ in strip] for strip in path.strips.as_arrow_array().to_pylist()]
    assert strips == [pytest.approx(xs) for xs in ([3.0, 3.1], [3.1, 3.2, 3.3], [3.3, 3.4])]
    bright, dim, again = path.colors.as_arrow_array().to_pylist()
    assert bright == again > dim
    assert "floor/visual" not in dict(scene.update(3 * SECOND))
    anew = dict(look_at(scene, SECOND, instance="v2"))["frames/visual_path"]
    assert anew.translation.as_arrow_array().to_pylist()[0] == pytest.approx([1.0, 2.0, 0.0])


def test_its_marks_fit_the_picture_that_is_shown_and_go_when_no_more_come() -> None:
    scene = Scene(stock("sim"))
    assert look_at(scene, SECOND) == [], "nobody has asked for a picture"
    scene.on_sample(topics.CAMERA, Picture(camera="head", jpeg=b"", width=320, height=240, tick=at(SECOND)), SECOND)
    marks = {path.rpartition("/")[2]: what for path, what in look_at(scene, SECOND)}
    assert points_of(marks["tracked"]) == [[159.0, 119.0], [1.0, 1.0]]
    assert points_of(marks["rejected"]) == [[21.0, 41.0]]
    assert marks["ground"].strips.as_arrow_array().to_pylist() == [[[1, 81], [319, 81], [319, 239], [1, 81]]]
    assert points_of(marks["reason"]) == []
    dark = look_at(scene, SECOND, reason=Trouble("dark"), width=0, height=0, tracked=(), rejected=(), ground=())
    assert dict(dark)["camera/head/vision/reason"].labels.as_arrow_array().to_pylist() == ["no visual odometry: dark"]
    apart = dict(
        look_at(scene, SECOND, reason=Trouble("they disagree"), motion=(0.0, 0.0, 0.0), wheels=(0.3, 0.4, 0.1))
    )
    [label] = apart["camera/head/vision/reason"].labels.as_arrow_array().to_pylist()
    assert "(picture: 0.00 m and 0°, wheels: 0.50 m and 6°)" in label.replace("\n", " ")
    assert "camera/head/vision" not in dict(scene.update(SECOND + 400 * MS))
    assert isinstance(dict(scene.update(SECOND + 600 * MS))["camera/head/vision"], rr.Clear)
    assert "camera/head/vision" not in dict(scene.update(SECOND + 700 * MS))
