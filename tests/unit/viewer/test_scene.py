"""What samples become on the screen, without one."""

import math
from itertools import pairwise
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pytest
import rerun as rr
from rerun.components import AggregationPolicy

from giraff_core.kinematics.pose import ELLIPSE_95
from giraff_core.operator import Operator, Wish
from giraff_schemas import topics
from giraff_schemas.camera import Picture
from giraff_schemas.messages import Tick, TruePose
from giraff_viewer.event_text import EventText, drawable
from giraff_viewer.machine import require_memory
from giraff_viewer.plots import Values
from giraff_viewer.rows import Row
from giraff_viewer.scene import Scene, stock
from giraff_viewer.shapes import Strip, Trail, ellipse, headings, outline
from giraff_viewer.show import Show
from tests.unit.cli.samples import MS, at, attitude, base, estop, guard, odometry, reading, verdict, wheels

SECOND = 1_000_000_000
BLOCKED = verdict(0.0, "blocked", "front_left", "front_left sees something at 0.37 m", "turn left")


def paths(rows: list[Row]) -> set[str]:
    return {path for path, _ in rows}


def colour_of(archetype: Any) -> int:
    """As rerun has it: 0xRRGGBBAA."""
    return int(archetype.colors.as_arrow_array().to_pylist()[0])


def test_frames_are_those_of_rep_105() -> None:
    rows = dict(row for row in Scene(stock("sim")).begin() if isinstance(row[1], rr.Transform3D))
    assert list(rows) == ["frames/map"]
    assert rows["frames/map"].parent_frame.as_arrow_array().to_pylist() == ["floor"]


def test_odometry_moves_base_link_and_draws_the_way() -> None:
    scene = Scene(stock("sim"))
    first = dict(scene.on_sample(topics.ODOM, odometry(SECOND, 1.0, 2.0, 0.5), SECOND))
    where = first["frames/base_link"]
    assert where.parent_frame.as_arrow_array().to_pylist() == ["odom"]
    assert where.translation.as_arrow_array().to_pylist() == [[1.0, 2.0, 0.0]]
    assert paths(scene.on_sample(topics.ODOM, odometry(SECOND, 1.1, 2.0), SECOND + 10 * MS)) == set()
    numbers = first["floor/grid/numbers"].labels.as_arrow_array().to_pylist()
    assert numbers == ["x 1 m", "x 2 m", "y 2 m", "y 3 m"]
    assert "floor/path" in paths(scene.update(SECOND + 600 * MS))
    assert "floor/path" not in paths(scene.update(SECOND + 2000 * MS))


def strips_of(archetype: Any) -> list[Any]:
    return [np.array(strip) for strip in archetype.strips.as_arrow_array().to_pylist()]


def test_odometry_has_an_ellipse_about_it_and_the_headings_that_it_may_have() -> None:
    scene = Scene(stock("sim"))
    sure = odometry(SECOND, 1.0, 2.0, math.pi / 2.0)
    sample = msgspec.structs.replace(sure, covariance=(0.04, 0.0, 0.0, 0.01, 0.0, 0.01))
    place, left, right = strips_of(dict(scene.on_sample(topics.ODOM, sample, SECOND))["floor/ellipse"])
    assert place.min(axis=0) == pytest.approx([1.0 - 0.2 * ELLIPSE_95, 2.0 - 0.1 * ELLIPSE_95], abs=2e-3)
    assert place.max(axis=0) == pytest.approx([1.0 + 0.2 * ELLIPSE_95, 2.0 + 0.1 * ELLIPSE_95], abs=2e-3)
    for way, side in ((left, 1.0), (right, -1.0)):
        ahead, aside = way[1] - way[0]
        assert tuple(way[0]) == (1.0, 2.0)
        assert math.atan2(aside, ahead) == pytest.approx(math.pi / 2.0 + side * 0.196, abs=1e-5)
    again = [scene.on_sample(topics.ODOM, odometry(n, 0.0), 2 * SECOND + n * 10 * MS) for n in range(100)]
    assert sum("floor/ellipse" in paths(rows) for rows in again) == 25


def true_pose(robot_ns: int, x: float, y: float, yaw: float = 0.0) -> TruePose:
    return TruePose(x=x, y=y, yaw=yaw, tick=at(robot_ns))


def test_a_simulated_robot_has_its_true_outline_beside_it() -> None:
    scene = Scene(stock("sim"))
    assert scene.on_sample(topics.TRUE_POSE, true_pose(SECOND, 0.0, 0.0), SECOND) == [], "odometry has not begun"
    for step in range(30):  # 0.6 m/s
        scene.on_sample(topics.ODOM, odometry(SECOND + step * 10 * MS, 0.006 * step), SECOND + step * 10 * MS)
    late = dict(scene.on_sample(topics.TRUE_POSE, true_pose(SECOND + 100 * MS, 0.06, 0.1), SECOND + 300 * MS))
    strips = strips_of(late["floor/truth"])
    assert (strips[0].min(axis=0) + strips[0].max(axis=0)) / 2 == pytest.approx([0.0, 0.1], abs=1e-3)
    assert colour_of(late["floor/truth"]) != colour_of(dict(scene.begin())["floor/robot"])
    assert late["floor/truth"].labels.as_arrow_array().to_pylist() == ["truth"]
    other = msgspec.structs.replace(true_pose(SECOND, 0.0, 0.0), tick=other_epoch())
    assert scene.on_sample(topics.TRUE_POSE, other, 2 * SECOND) == [], "nothing is known of that time"


def test_a_true_pose_is_held_against_no_odometry_of_another_frame() -> None:
    """It was told in the frame from before, and is drawn in the one that counts now as soon as it is told in it."""
    scene = Scene(stock("sim"))
    scene.on_sample(topics.ODOM, odometry(SECOND, 0.0), SECOND)
    scene.on_sample(topics.ODOM, msgspec.structs.replace(odometry(SECOND + 10 * MS, 5.0), jumps=1), SECOND)
    assert scene.on_sample(topics.TRUE_POSE, true_pose(SECOND + 4 * MS, 0.0, 0.0), SECOND) == []
    later = dict(scene.on_sample(topics.TRUE_POSE, true_pose(SECOND + 12 * MS, 5.0, 0.1), SECOND + 50 * MS))
    strips = strips_of(later["floor/truth"])
    assert (strips[0].min(axis=0) + strips[0].max(axis=0)) / 2 == pytest.approx([0.0, 0.1], abs=1e-3)


def area(strip: Strip) -> float:
    return sum(x * later_y - later_x * y for (x, y), (later_x, later_y) in pairwise(strip)) / 2.0


@pytest.mark.parametrize("angle", [0.0, 0.4, math.pi / 2.0, 2.5])
@pytest.mark.parametrize(("long", "short"), [(0.3, 0.1), (0.2, 0.2), (0.5, 0.0), (0.0, 0.0), (1.0, 1e-9)])
def test_an_ellipse_has_the_axes_of_its_covariance(long: float, short: float, angle: float) -> None:
    cos, sin = math.cos(angle), math.sin(angle)
    xx, yy = (long * cos) ** 2 + (short * sin) ** 2, (long * sin) ** 2 + (short * cos) ** 2
    strip = ellipse(xx, (long**2 - short**2) * cos * sin, yy)
    assert len(strip) == 49
    assert strip[0] == pytest.approx(strip[-1], abs=1e-9)
    assert area(strip) == pytest.approx(math.pi * 5.991 * long * short, rel=5e-3, abs=1e-7)
    assert max(x * cos + y * sin for x, y in strip) == pytest.approx(long * math.sqrt(5.991), rel=5e-3, abs=1e-7)
    assert max(y * cos - x * sin for x, y in strip) == pytest.approx(short * math.sqrt(5.991), rel=5e-3, abs=1e-6)


def test_an_ellipse_holds_95_of_100_points() -> None:
    xx, xy, yy = 0.05, 0.02, 0.01
    points = np.random.default_rng(1).multivariate_normal((0.0, 0.0), [[xx, xy], [xy, yy]], 20_000)
    corners = np.array(ellipse(xx, xy, yy))
    edges, starts = np.diff(corners, axis=0), corners[:-1]
    to_point = points[:, None, :] - starts
    inside = (edges[:, 0] * to_point[:, :, 1] - edges[:, 1] * to_point[:, :, 0] >= 0.0).all(axis=1)
    assert inside.mean() == pytest.approx(0.95, abs=0.005)


@pytest.mark.parametrize(
    "covariance", [(-1.0, 0.0, -1.0), (1e308, 1e308, 1e308), (0.0, 1.0, 0.0), (1e308, 0.0, -1e308)]
)
def test_a_covariance_that_is_none_can_be_drawn(covariance: tuple[float, float, float]) -> None:
    assert np.isfinite(ellipse(*covariance)).all()
    assert np.isfinite(headings(covariance[0], 0.3)).all()


def test_the_outline_is_as_wide_as_the_footprint() -> None:
    assert max(math.hypot(*point) for strip in outline(0.3, 0.47) for point in strip) == pytest.approx(0.3)


def test_a_trail_stays_short_and_begins_anew() -> None:
    trail = Trail()
    for step in range(100_000):
        trail.go_on(step * 0.02, 0.0, ("a", 0))
    assert len(trail.points) <= 1000
    assert trail.points[0] == (0.0, 0.0)
    assert trail.points[-1][0] > 1990.0
    assert not trail.go_on(*trail.points[-1], ("a", 0))
    assert trail.go_on(0.0, 0.0, ("b", 0))
    assert trail.points == [(0.0, 0.0)]


def test_a_trail_has_no_line_over_a_jump_and_has_one_over_a_gap() -> None:
    """However near the pose was set; and however far the robot went unheard, it went there."""
    trail = Trail()
    trail.go_on(0.0, 0.0, ("a", 0))
    trail.go_on(3.0, 0.0, ("a", 0))
    assert trail.points == [(0.0, 0.0), (3.0, 0.0)]
    assert trail.go_on(3.01, 0.0, ("a", 1))
    assert trail.points == [(3.01, 0.0)]
    scene = Scene(stock("sim"))
    for jumps, x in ((0, 0.0), (0, 0.1), (1, 0.2), (1, 0.3)):
        rows = scene.on_sample(topics.ODOM, msgspec.structs.replace(odometry(SECOND, x), jumps=jumps), SECOND)
        assert rows or x
    [drawn] = [what for path, what in scene.update(2 * SECOND) if path == "floor/path"]
    [strip] = drawn.strips.as_arrow_array().to_pylist()
    assert [point[0] for point in strip] == pytest.approx([0.2, 0.3])


def test_the_log_tells_each_change_once_with_its_reason() -> None:
    story = EventText()
    assert ("INFO", "base: driving") in story.on_sample(base())
    assert story.on_sample(base()) == []
    assert story.on_sample(base(armed=False, reason="0.31 m")) == [("WARN", "base: not armed: 0.31 m")]
    assert story.on_sample(base(armed=False, reason="0.32 m")) == []
    assert ("WARN", "guard forward: blocked by front_left") in story.on_sample(guard(BLOCKED))
    reason = estop(engaged=True).reason
    assert story.on_sample(estop(engaged=True)) == [("ERROR", f"e-stop: engaged by ann@desk: {reason}")]
    assert story.page.startswith("# EMERGENCY STOP\n\nann@desk: smoke")
    assert (
        "| forward | **blocked** | 0.00 | front_left | front_left sees something at 0.37 m; turn left |" in story.page
    )


def test_text_of_the_network_can_be_drawn_and_breaks_no_table() -> None:
    assert drawable("a\x1b[1m \U0001f408 ö") == "a?[1m ? ö"
    story = EventText()
    story.on_sample(guard(verdict(0.0, "blocked", "a|b", "c|d\ne")))
    assert "| a/b | c/d?e |" in story.page


def test_ages_are_those_of_the_robots_clock() -> None:
    values = Values()
    assert dict(values.of(odometry(SECOND, 0.0))) == {"plots/speed/measured": 0.4, "plots/turn/measured": 0.0}
    assert dict(values.of(Tick(epoch=7, robot_ns=2 * SECOND))) == {}
    assert dict(values.of(odometry(SECOND, 0.0)))["plots/ages/odom"] == 1.0
    assert "plots/ages/odom" not in dict(values.of(msgspec.structs.replace(odometry(0, 0.0), tick=other_epoch())))
    assert math.isnan(dict(values.of(reading("rear", None, "clear")))["plots/ranges/rear"])


def test_a_budget_that_is_used_up_is_not_drawn() -> None:
    states = [msgspec.structs.replace(base(), budget_left=left) for left in (0.1, 0.0, -1.0, None)]
    drawn = [dict(Values().of(state))["plots/ages/budget_left"] for state in states]
    assert drawn[:2] == [0.1, 0.0]
    assert all(map(math.isnan, drawn[2:]))


def other_epoch() -> Any:
    return msgspec.structs.replace(at(0), epoch=8)


def test_a_line_gets_25_points_a_second() -> None:
    scene = Scene(stock("sim"))
    points = [scene.on_sample(topics.ODOM, odometry(n, 0.0), SECOND + n * 10 * MS) for n in range(100)]
    assert sum("plots/speed/measured" in paths(rows) for rows in points) == 25


def test_an_operator_that_watches_draws_no_zeros_between_the_commands_of_another() -> None:
    watching, driving = Operator("web", "w", asks_from_start=False), Operator("demo", "d")
    assert list(Values().of(watching.say(Wish(0.0, 0.0, None)))) == []
    assert ("plots/speed/commanded", 0.3) in Values().of(driving.say(Wish(0.3, 0.0, None)))


def test_a_robot_that_balances_has_plots_of_its_own_and_others_have_none() -> None:
    scene = Scene(stock("sim"))
    assert paths(scene.on_sample(topics.WHEELS, wheels(0), SECOND)) == {"plots/pwm/left", "plots/pwm/right"}
    rows = dict(scene.on_sample(topics.ATTITUDE, attitude(0), SECOND))
    degrees = {path: what.scalars.as_arrow_array().to_pylist()[0] for path, what in rows.items()}
    assert degrees["plots/lean/fused"] == pytest.approx(1.5)
    assert degrees["plots/rate/rate"] == pytest.approx(math.degrees(-0.1))
    assert scene.balances
    seen = paths(scene.on_sample(topics.WHEELS, wheels(0), 2 * SECOND)) | set(degrees)
    assert seen >= paths(scene.begin_balance())


def test_a_line_that_swings_is_drawn_with_its_peaks() -> None:
    rows = Scene(stock("sim")).begin_balance()
    policies = {path: row.aggregation_policy.as_arrow_array().to_pylist() for path, row in rows}
    assert policies == {path: [AggregationPolicy.MinMax.value] for path in paths(rows)}


@pytest.mark.parametrize("balances", [False, True])
def test_the_screen_gets_those_plots_with_the_first_attitude(tmp_path: Path, balances: bool) -> None:
    show = Show(stock("sim"), live=False)
    show.to_file(tmp_path / "drive.rrd")
    for second in (1, 2):
        show.on_sample(topics.WHEELS, wheels(0), second * SECOND)
        if balances:
            show.on_sample(topics.ATTITUDE, attitude(0), second * SECOND)
    show.close()
    assert (tmp_path / "drive.rrd").read_bytes().count(b"motor command, 255") == balances


def test_a_robot_that_tells_its_shape_late_is_drawn_anew(tmp_path: Path) -> None:
    """No cone of the other shape is left, nor the words beside it."""
    show = Show(stock("sim"), live=False, note="drawn as a stock Giraff")
    show.to_file(tmp_path / "drive.rrd")
    show.draw(msgspec.structs.replace(stock("sim"), sensors={}), SECOND)
    show.close()
    assert (tmp_path / "drive.rrd").read_bytes().count(b"ClearIsRecursive")
    labels = [dict(Scene(stock("sim"), note).begin())["floor/robot"].labels for note in ("of a file", "")]
    assert [each.as_arrow_array().to_pylist() for each in labels] == [["of a file"], []]


@pytest.mark.parametrize("limit", ["500MB", "2GiB", "1.5 GB", "25%"])
def test_a_limit_is_taken(limit: str) -> None:
    assert require_memory(limit) == limit.replace(" ", "")


@pytest.mark.parametrize("limit", ["", "12", "MB", "-1GB", "1kB", "49MB", "0%", "100%", "infGB", "1PB"])
def test_a_bad_limit_is_refused(limit: str) -> None:
    with pytest.raises(ValueError, match=r"give"):
        require_memory(limit)


def test_a_picture_is_shown_with_its_age_and_says_when_it_is_old() -> None:
    scene = Scene(stock("sim"))
    seen = Picture(camera="head", jpeg=b"\xff\xd8", width=320, height=240, tick=at(SECOND))
    scene.on_sample(topics.TICK, Tick(epoch=at(0).epoch, robot_ns=SECOND + 80 * MS), 5 * SECOND)
    drawn = dict(scene.on_sample(topics.CAMERA, seen, 5 * SECOND + 20 * MS))
    assert drawn["camera/head"].media_type.as_arrow_array().to_pylist() == ["image/jpeg"]
    assert scene.cameras == ("head",)

    def label(rows: list[Row]) -> list[str]:
        return [
            text
            for path, what in rows
            if path == "camera/head/age"
            for text in what.labels.as_arrow_array().to_pylist()
        ]

    assert label(list(drawn.items())) == ["0.10 s"]
    told = [text for tenths in range(10, 36) for text in label(scene.update(4 * SECOND + tenths * 100 * MS))]
    assert told == ["OLD: over 0.5 s", "OLD: 1 s", "OLD: 2 s"]
    epoch_later = Tick(epoch=at(0).epoch + 1, robot_ns=0)
    scene.on_sample(topics.TICK, epoch_later, 8 * SECOND)
    assert label(scene.update(8 * SECOND)) == ["OLD: nothing tells its age"]
