"""The room and the echoes on the screen, without one."""

import msgspec
import pytest

from giraff_core.kinematics.echoes import CELL
from giraff_core.senses import Ultrasonic
from giraff_schemas import topics
from giraff_schemas.requests import EchoMap
from giraff_viewer.scene import Scene, stock
from tests.unit.cli.samples import MS, at, odometry, reading
from tests.unit.viewer.test_scene import SECOND, paths, strips_of, true_pose
from tests.unit.viewer.test_whereabouts import WALLS

LINES = (((-1.0, -2.0), (3.0, -2.0), (3.0, 2.0)),)
TRUTH = msgspec.structs.replace(true_pose(SECOND, 0.0, 0.0), walls=LINES)
EARLIER = EchoMap(instance="", jumps=0, cell=CELL, columns=(20, -40), rows=(0, 10))


def test_the_room_of_a_simulated_robot_is_drawn_once_in_odom() -> None:
    scene = Scene(stock("sim"))
    rows = dict(scene.on_sample(topics.TRUE_POSE, TRUTH, SECOND))
    assert [strip.tolist() for strip in strips_of(rows["floor/room"])] == [[[-1.0, -2.0], [3.0, -2.0], [3.0, 2.0]]]
    assert "floor/grid" in rows
    assert scene.on_sample(topics.TRUE_POSE, TRUTH, 3 * SECOND) == []
    assert scene.on_sample(topics.TRUE_POSE, true_pose(SECOND, 0.0, 0.0), 4 * SECOND) == [], "it says no room"
    frames = {path: what.frame for path, what in scene.begin() if path in ("floor/room", "floor/echoes")}
    assert {str(frame.as_arrow_array().to_pylist()[0]) for frame in frames.values()} == {"odom"}


def test_a_map_takes_the_room_away_for_good() -> None:
    scene = Scene(stock("sim"))
    scene.on_sample(topics.TRUE_POSE, TRUTH, SECOND)
    empty = msgspec.structs.replace(WALLS, walls=())
    assert "floor/room" not in paths(scene.on_sample(topics.MAP, empty, SECOND))
    rows = dict(scene.on_sample(topics.MAP, WALLS, SECOND))
    assert strips_of(rows["floor/room"]) == []
    numbers = rows["floor/grid/numbers"].labels.as_arrow_array().to_pylist()
    assert numbers[0] == "x 0 m", "the grid is about the map alone"
    anew = msgspec.structs.replace(TRUTH, walls=(LINES[0][:2],))
    assert "floor/room" not in paths(scene.on_sample(topics.TRUE_POSE, anew, 3 * SECOND))


def test_echoes_from_before_are_there_at_the_first_pose_and_new_ones_join_them() -> None:
    scene = Scene(stock("sim"))
    scene.begin_with(EARLIER)
    assert "floor/echoes" not in paths(scene.update(SECOND)), "it is not known whether they are of this odometry"
    scene.on_sample(topics.ODOM, odometry(SECOND, 0.0), SECOND)
    heard = msgspec.structs.replace(reading("front_left", 1.0), tick=at(SECOND))
    scene.on_sample(topics.RANGE, heard, SECOND + 20 * MS)
    dots = dict(scene.update(2 * SECOND))["floor/echoes"].positions.as_arrow_array().to_pylist()
    sensor = stock("sim").of(Ultrasonic)["front_left"]
    assert dots == [
        pytest.approx([1.0, 0.0]),
        pytest.approx([-2.0, 0.5]),
        pytest.approx([sensor.x + 1.0, sensor.y], abs=CELL / 2),
    ]
    assert "floor/echoes" not in paths(scene.update(4 * SECOND)), "nothing is new"


def test_echoes_of_another_odometry_are_not_drawn() -> None:
    scene = Scene(stock("sim"))
    scene.begin_with(EARLIER)
    scene.on_sample(topics.ODOM, msgspec.structs.replace(odometry(SECOND, 0.0), jumps=1), SECOND)
    assert "floor/echoes" not in paths(scene.update(2 * SECOND))
