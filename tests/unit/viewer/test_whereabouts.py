"""Where the robot is on the map, as the screen has it, without one."""

import math
from typing import Any, Final

import msgspec
import numpy as np
import pytest

from giraff_core.kinematics.pose import ELLIPSE_95, Pose
from giraff_schemas import topics
from giraff_schemas.localization import Candidate, LocalizationState, MapPose, MapWalls, Particles
from giraff_schemas.places import NO_ROUTE, NoGoLine, Place, Places
from giraff_schemas.trouble import Trouble
from giraff_viewer.colours import PLACES
from giraff_viewer.rows import Row
from giraff_viewer.scene import Scene, stock
from tests.support.map_poses import LOST, map_pose
from tests.support.motion_double import route_state
from tests.unit.cli.samples import at, odometry
from tests.unit.viewer.test_scene import SECOND, colour_of, paths, strips_of

ODOM: Final = Pose(4.0, 1.0, math.pi / 2.0)
WALLS: Final = MapWalls(map="flat", walls=((0.0, 0.0, 5.0, 0.0), (5.0, 0.0, 5.0, 4.0)))


def pose(state: LocalizationState = "localized", candidates: tuple[Candidate, ...] = (), odom: Pose = ODOM) -> MapPose:
    return map_pose(odom, Pose(1.0, 0.0, 0.0), at(SECOND), state, candidates)


def frame(rows: list[Row], child: str) -> tuple[str, list[float]]:
    """What it is in, and where."""
    [found] = [what for path, what in rows if path == f"frames/{child}"]
    [parent] = found.parent_frame.as_arrow_array().to_pylist()
    [where] = found.translation.as_arrow_array().to_pylist()
    return parent, where


def texts(rows: list[Row]) -> list[str]:
    """Of the log."""
    return [what.text.as_arrow_array().to_pylist()[0] for path, what in rows if path == "log"]


def page(rows: list[Row]) -> str:
    [document] = [what for path, what in rows if path == "guard"]
    text: str = document.text.as_arrow_array().to_pylist()[0]
    return text


def test_without_a_map_odom_is_the_map() -> None:
    scene = Scene(stock("sim"))
    assert frame(scene.on_sample(topics.ODOM, odometry(SECOND, 1.0), SECOND), "odom") == ("map", [0.0, 0.0, 0.0])
    assert "frames/odom" not in paths(scene.on_sample(topics.ODOM, odometry(SECOND, 1.0), 2 * SECOND))
    no_map = pose("no_map")
    assert paths(scene.on_sample(topics.POSE, no_map, 2 * SECOND)) == {"log", "guard"}, "which say why"
    assert "frames/odom" in paths(scene.on_sample(topics.ODOM, odometry(SECOND, 1.0), 7 * SECOND)), (
        "it is not forgotten"
    )


def test_a_pose_on_the_map_moves_odom_and_all_that_hangs_below() -> None:
    scene = Scene(stock("sim"))
    scene.on_sample(topics.POSE, pose(), SECOND)
    assert frame(scene.on_sample(topics.POSE, pose(odom=ODOM._replace(x=4.5)), SECOND), "odom") == (
        "map",
        [4.5, 1.0, 0.0],
    )
    assert "frames/odom" not in paths(scene.on_sample(topics.ODOM, odometry(SECOND, 1.0), SECOND))
    assert {
        str(what.frame.as_arrow_array().to_pylist()[0]) for path, what in scene.begin() if path == "floor/path"
    } == {"odom"}


def test_the_ellipse_is_about_the_place_and_its_colour_says_whether_it_is_known() -> None:
    scene = Scene(stock("sim"))
    rows = dict(scene.on_sample(topics.POSE, pose(), SECOND))
    place, *ways = strips_of(rows["floor/place"])
    assert (place.min(axis=0) + place.max(axis=0)) / 2.0 == pytest.approx([4.0, 2.0], abs=1e-3)
    assert np.ptp(place, axis=0) == pytest.approx([0.2 * ELLIPSE_95] * 2, abs=2e-3)
    assert len(ways) == 2
    for state in ("localized", "ambiguous", "lost"):
        rows = dict(scene.on_sample(topics.POSE, pose(state), SECOND))
        red, green, blue = PLACES[state]
        assert colour_of(rows["floor/place"]) >> 8 == red << 16 | green << 8 | blue


def test_candidates_are_outlines_with_their_belief_until_it_is_known() -> None:
    scene = Scene(stock("sim"))
    two = (Candidate(x=1.0, y=2.0, yaw=0.0, belief=0.62), Candidate(x=3.0, y=2.0, yaw=1.0, belief=0.0))
    drawn = dict(scene.on_sample(topics.POSE, pose("ambiguous", two), SECOND))["floor/candidates"]
    strips, each = strips_of(drawn), len(strips_of(drawn)) // 2
    for number, x in ((0, 1.0), (each, 3.0)):
        assert (strips[number].min(axis=0) + strips[number].max(axis=0)) / 2.0 == pytest.approx([x, 2.0], abs=2e-3)
    labels = [label for label in drawn.labels.as_arrow_array().to_pylist() if label]
    assert labels == ["62 %", "0 %"]
    assert "floor/candidates" not in paths(scene.on_sample(topics.POSE, pose("ambiguous", two), SECOND))
    assert strips_of(dict(scene.on_sample(topics.POSE, pose(), SECOND))["floor/candidates"]) == []


def test_walls_are_drawn_once_and_particles_as_they_come() -> None:
    scene = Scene(stock("sim"))
    walls = dict(scene.on_sample(topics.MAP, WALLS, SECOND))["floor/walls"]
    assert [strip.tolist() for strip in strips_of(walls)] == [[[0.0, 0.0], [5.0, 0.0]], [[5.0, 0.0], [5.0, 4.0]]]
    assert scene.on_sample(topics.MAP, WALLS, 2 * SECOND) == []
    other = msgspec.structs.replace(WALLS, walls=WALLS.walls[:1])
    assert paths(scene.on_sample(topics.MAP, other, 3 * SECOND)) == {"floor/walls"}
    some = Particles(x=(1.0, 2.0), y=(0.5, 0.6), yaw=(0.0, 0.0))
    points: Any = dict(scene.on_sample(topics.PARTICLES, some, SECOND))["floor/particles"]
    assert points.positions.as_arrow_array().to_pylist() == [[1.0, 0.5], [2.0, pytest.approx(0.6)]]


def test_places_and_no_go_lines_are_drawn_when_they_change_on_their_own_map() -> None:
    scene = Scene(stock("sim"))
    desk = Place(name="desk", x=1.0, y=2.0, yaw=math.pi / 2.0)
    stairs = NoGoLine(name="stairs", x=0.0, y=1.0, end_x=2.0, end_y=1.0)
    known = Places(map="flat", places=(desk,), no_go=(stairs,))
    assert scene.on_sample(topics.PLACES, known, SECOND) == [], "no map was heard"
    drawn = dict(scene.on_sample(topics.MAP, WALLS, SECOND))
    [arrow], [line] = strips_of(drawn["floor/named_places"]), strips_of(drawn["floor/no_go"])
    assert arrow[1].tolist() == pytest.approx([1.0, 2.15])
    assert line.tolist() == [[0.0, 1.0], [2.0, 1.0]]
    assert drawn["floor/named_places"].labels.as_arrow_array().to_pylist() == ["desk"]
    assert scene.on_sample(topics.PLACES, known, 2 * SECOND) == []
    idle = msgspec.structs.replace(known, reason=Trouble("localization goes by another plan"))
    gone = dict(scene.on_sample(topics.PLACES, idle, 3 * SECOND))
    assert [strips_of(gone[path]) for path in ("floor/named_places", "floor/no_go")] == [[], []]
    assert {"floor/named_places", "floor/no_go"} <= paths(scene.begin()), "which are in the frame of the map"


def test_a_route_is_drawn_when_it_changes_until_it_has_ended() -> None:
    scene = Scene(stock("sim"))
    assert scene.on_sample(topics.ROUTE, NO_ROUTE, SECOND) == []
    drawn = dict(scene.on_sample(topics.ROUTE, route_state(1), SECOND))
    [strip], goal = strips_of(drawn["floor/route"]), drawn["floor/goal"]
    assert strip.tolist() == [pytest.approx(corner) for corner in ((1.0, 3.0), (4.1, 3.0), (6.3, 1.8))]
    assert goal.positions.as_arrow_array().to_pylist() == [pytest.approx([6.3, 1.8])]
    assert goal.labels.as_arrow_array().to_pylist() == ["kitchen"]
    assert scene.on_sample(topics.ROUTE, route_state(1, step=3), 2 * SECOND) == []
    gone = dict(scene.on_sample(topics.ROUTE, route_state(1, "ended", "blocked"), 3 * SECOND))
    assert (strips_of(gone["floor/route"]), gone["floor/goal"].positions.as_arrow_array().to_pylist()) == ([], [])
    assert {"floor/route", "floor/goal"} <= paths(scene.begin()), "which are in the frame of the map"


def test_the_page_and_the_log_say_whether_it_is_known() -> None:
    scene = Scene(stock("sim"))
    rows = scene.on_sample(topics.POSE, pose("lost"), SECOND)
    assert texts(rows) == [f"map: lost on flat: {LOST}"]
    assert page(rows) == f"**map** lost on flat: {LOST}"
    assert "log" not in paths(scene.on_sample(topics.POSE, pose("lost"), SECOND))
    assert texts(scene.on_sample(topics.POSE, pose(), SECOND)) == ["map: localized on flat"]
