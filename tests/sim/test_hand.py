"""The hand: scripts as written, and a person who gets a robot round a room."""

import itertools
import math
import statistics
from pathlib import Path

import pytest

from giraff_sim.config import SimConfig
from giraff_sim.world.bno055 import Vector
from giraff_sim.world.demo_hand import DemoHand
from giraff_sim.world.hand import Dropped, Hand, LaidDown, ScriptError, Shaken, StillHand, Tremor, read_script
from giraff_sim.world.room import Pose, read_room
from tests.sim.robots import EXACT, ORIGIN, empty_room, world_in

LIVING_ROOM = Path(__file__).parents[2] / "deploy" / "worlds" / "living_room.toml"
STEP = 0.008


def written(tmp_path: Path, text: str) -> Path:
    path = tmp_path / "tilt.csv"
    path.write_text(text, encoding="utf-8")
    return path


def test_rows_hold_until_the_next_and_the_last_for_ever(tmp_path: Path) -> None:
    hand = read_script(written(tmp_path, "t, x, y, z\n1.0, 7.0, 0.0, 6.8\n2.5, 0, -5, 8.4\n"), begin=10.0)
    assert hand.acceleration(0.0, ORIGIN) == (7.0, 0.0, 6.8)
    assert hand.acceleration(12.499, ORIGIN) == (7.0, 0.0, 6.8)
    assert hand.acceleration(12.5, ORIGIN) == (0.0, -5.0, 8.4)
    assert hand.acceleration(1e6, ORIGIN) == (0.0, -5.0, 8.4)


def test_a_script_needs_no_names_and_may_have_a_mark_and_empty_lines(tmp_path: Path) -> None:
    hand = read_script(written(tmp_path, "\ufeff0,1,2,3\n\n1,4,5,6\n"))
    assert hand.acceleration(0.5, ORIGIN) == (1.0, 2.0, 3.0)


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("", "holds no row"),
        ("t,x,y,z\n", "holds no row"),
        ("0,1,2\n", "tilt.csv:1: 3 columns"),
        ("0,1,2,3\n1,1,2,up\n", "tilt.csv:2: z is 'up', not a number"),
        ("0,1,nan,3\n", "tilt.csv:1: y is nan: it must be finite"),
        ("1,1,2,3\n1,1,2,3\n", "tilt.csv:2: time 1 does not come after 1"),
        (
            "0,0,0,1\n1,0.6,0.1,0.8\n2,0,0,0\n",
            "tilt.csv: x, y, z make 1.00 together, like g: make them m/s², times 9.8",
        ),
        (
            "0,0,0,1000\n1,600,100,800\n",
            "tilt.csv: x, y, z make 1002.49 together, like mg: make them m/s², times 0.0098",
        ),
        ("0,0,0,9806\n", "tilt.csv: x, y, z make 9806 together: make them m/s², 9.8 where it is held still"),
        ("0,0,0,9.8\n100000000,1,0,9.8\n", "tilt.csv: it lasts 1e.08 s, more than a day: are the times in ms or ns?"),
        ("1764284023.5,0,0,9.8\n", "tilt.csv:1: time 1764284023.5 is none in s from the start: take it off each row"),
        ("t,x,z,y\n0,1,2,3\n", "tilt.csv:1: t is 't'"),
    ],
)
def test_a_mistake_is_named_with_its_line(tmp_path: Path, text: str, complaint: str) -> None:
    with pytest.raises(ScriptError, match=complaint):
        read_script(written(tmp_path, text))


def test_a_missing_script_is_named(tmp_path: Path) -> None:
    with pytest.raises(ScriptError, match=r"none\.csv: cannot be read"):
        read_script(tmp_path / "none.csv")


def test_a_still_hand_holds_what_it_was_told() -> None:
    assert StillHand().acceleration(3.0, ORIGIN) == (0.0, 0.0, 9.80665)
    assert StillHand((1.0, 2.0, 3.0)).acceleration(3.0, ORIGIN) == (1.0, 2.0, 3.0)
    with pytest.raises(ValueError, match="finite"):
        StillHand((math.nan, 0.0, 0.0))


def felt(hand: Hand, seconds: float, *, sim: SimConfig = EXACT, seed: int = 1) -> list[Vector]:
    """What the sensor feels every 8 ms in a world that this hand is in."""
    world = world_in(empty_room(), sim, seed)
    world.hand = hand
    vectors = []
    for step in range(round(seconds * 1000)):
        world.step(None)
        if step % 8 == 0:
            vectors.append(world.acceleration)
    return vectors


@pytest.mark.parametrize("hand", [StillHand((1.0, 2.0, 9.0)), LaidDown((1.0, 2.0, 9.0))])
def test_a_hand_trembles_as_much_as_it_is_told_and_a_thing_that_lies_does_not(hand: Hand) -> None:
    axes = list(zip(*felt(hand, 20.0), strict=True))
    for axis, middle in zip(axes, (1.0, 2.0, 9.0), strict=True):
        assert statistics.fmean(axis) == pytest.approx(middle, abs=0.003)
        assert statistics.pstdev(axis) == pytest.approx(EXACT.hand_tremor if hand.trembles else 0.0, rel=0.2)


def test_a_tremor_is_of_6_to_12_hertz_and_repeats_with_its_seed() -> None:
    one, same, other = (felt(StillHand(), 10.0, seed=seed) for seed in (1, 1, 2))
    assert one == same != other
    for axis in zip(*one, strict=True):
        middle = statistics.fmean(axis)
        crossings = sum((a < middle) != (b < middle) for a, b in itertools.pairwise(axis))
        assert 6.0 <= crossings / 2.0 / 10.0 <= 12.0


def test_without_tremor_a_hand_is_what_it_was_told() -> None:
    assert Tremor(0.0, 1).added_to((1.0, 2.0, 3.0), 0.7) == (1.0, 2.0, 3.0)


def test_one_laid_down_lies_tilted() -> None:
    x, y, z = LaidDown().acceleration(0.0, ORIGIN)
    assert math.degrees(math.atan2(x, z)) == pytest.approx(40.0)
    assert y == 0.0


def test_one_that_is_shaken_moves_to_and_fro() -> None:
    swings = [x for x, _, _ in felt(Shaken(0.0), 2.0)]
    assert max(swings) == pytest.approx(20.0, abs=0.5)
    assert min(swings) == pytest.approx(-20.0, abs=0.5)
    assert sum(a < 0.0 <= b for a, b in itertools.pairwise(swings)) == pytest.approx(10, abs=1)


def test_one_that_is_dropped_falls_hits_the_floor_and_lies() -> None:
    lengths = [math.hypot(*vector) for vector in felt(Dropped(0.0), 2.0)]
    falling = [length for length in lengths if length < 3.0]
    assert len(falling) * STEP == pytest.approx(0.45, abs=0.02)
    assert max(lengths) > 30.0
    assert lengths[100:] == pytest.approx([9.80665] * len(lengths[100:]))


def speed_for(acceleration: float, full: float) -> float:
    """A robot's answer to a tilt: nothing up to 8 degrees, all at 35."""
    tilt = math.degrees(math.asin(max(-1.0, min(1.0, acceleration / 9.80665))))
    return math.copysign(min(1.0, max(0.0, abs(tilt) - 8.0) / 27.0) * full, tilt)


def steer(hand: DemoHand, pose: Pose, seconds: float, *, is_blocked: bool = False, since: float = 0.0) -> list[Pose]:
    """An obedient robot, or one that does not move forward; its path."""
    path = [pose]
    for step in range(round(seconds / STEP)):
        x, y, _ = hand.acceleration(since + step * STEP, pose)
        speed, turn = speed_for(x, 0.6), speed_for(y, 1.57)
        if is_blocked:
            speed, turn = min(0.0, speed), 0.0
        yaw = pose.yaw + turn * STEP
        pose = Pose(pose.x + speed * STEP * math.cos(yaw), pose.y + speed * STEP * math.sin(yaw), yaw)
        path.append(pose)
    return path


def test_it_rests_a_second_before_it_sets_off() -> None:
    hand = DemoHand([(3.0, 1.0)], seed=1)
    for step in range(125):
        x, y, z = hand.acceleration(step * STEP, ORIGIN)
        assert abs(x) < 0.2
        assert abs(y) < 0.2
        assert math.hypot(x, y, z) == pytest.approx(9.80665)


@pytest.mark.parametrize("seed", range(2))
def test_it_steers_an_obedient_robot_round_the_living_room(seed: int) -> None:
    room = read_room(LIVING_ROOM)
    path = steer(DemoHand(room.waypoints, seed), room.start, 90.0)
    for x, y in room.waypoints:
        assert min(math.hypot(pose.x - x, pose.y - y) for pose in path) < 0.36
    assert min(room.clearance(pose.x, pose.y) for pose in path) > 0.6
    length = sum(math.hypot(b.x - a.x, b.y - a.y) for a, b in itertools.pairwise(path))
    assert length > 25.0


def test_it_moves_the_joystick_as_a_wrist_does() -> None:
    room = read_room(LIVING_ROOM)
    hand = DemoHand(room.waypoints, seed=3)
    pose = room.start
    before = hand.acceleration(0.0, pose)
    for step in range(1, 4000):
        now = hand.acceleration(step * STEP, pose)
        assert all(abs(a - b) < 0.35 for a, b in zip(now, before, strict=True))  # 2.5 degrees in 8 ms
        before = now


def test_seeds_differ_and_repeat() -> None:
    def tilts(seed: int) -> list[tuple[float, float, float]]:
        hand = DemoHand([(3.0, 1.0), (0.0, 3.0)], seed)
        return [hand.acceleration(step * STEP, ORIGIN) for step in range(400)]

    assert tilts(1) == tilts(1)
    assert tilts(1) != tilts(2)


def test_it_rests_then_backs_off_when_the_robot_does_not_get_on() -> None:
    hand = DemoHand([(3.0, 0.0), (0.0, 3.0)], seed=1)
    forward = [hand.acceleration(step * STEP, ORIGIN)[0] for step in range(round(14.0 / STEP))]
    at = [index for index, x in enumerate(forward) if x < -2.0]
    assert at  # it backs off in the end
    first = at[0]
    rests = [index for index in range(round(2.5 / STEP), first) if abs(forward[index]) < 0.3]
    assert len(rests) * STEP > 0.8  # but rests before: what a robot needs that wants to be armed again
    assert max(forward[:first]) > 3.0


def test_it_gets_a_robot_out_of_a_dead_end() -> None:
    hand = DemoHand([(3.0, 0.0), (-2.0, 0.0)], seed=2)
    path = steer(hand, ORIGIN, 12.0, is_blocked=True)
    assert path[-1].x < -0.15
    after = steer(hand, path[-1], 20.0, since=12.0)
    assert min(math.hypot(pose.x + 2.0, pose.y) for pose in after) < 0.36


def test_it_needs_waypoints() -> None:
    with pytest.raises(ValueError, match="waypoints"):
        DemoHand([], 1)
