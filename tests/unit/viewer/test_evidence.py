"""What each sensor tells becomes on the screen, without one."""

import math
from typing import Any

import msgspec
import numpy as np
import pytest
import rerun as rr

from giraff_core.senses import Bumper, Evidence, Ultrasonic
from giraff_schemas import topics
from giraff_schemas.bumper import Bump
from giraff_schemas.messages import GuardState, Range, SensorState
from giraff_schemas.topics import Topic
from giraff_schemas.trouble import Trouble
from giraff_viewer.colours import EVIDENCE
from giraff_viewer.evidence import SensorEvidence
from giraff_viewer.rows import Row
from giraff_viewer.scene import Scene, stock
from tests.support.robots import BUMPED, ROBOT
from tests.unit.cli.samples import guard, reading, verdict
from tests.unit.viewer.test_scene import SECOND, colour_of, strips_of


def seen_of(rows: list[Row], sensor: str) -> Any:
    """Newest drawing of a sensor."""
    return [what for path, what in rows if path == f"floor/evidence/{sensor}"][-1]


PUSHED = Bump(sensor="front", pressed=True, tick=None)


@pytest.mark.parametrize(
    ("topic", "sample", "blocks", "later", "state"),
    [
        (topics.RANGE, reading("front_left", None, "clear"), False, 0.1, "free"),
        (topics.RANGE, reading("front_left", 1.5), False, 0.1, "free"),
        (topics.RANGE, reading("front_left", 0.6), False, 0.1, "near"),
        (topics.RANGE, reading("front_left", 0.6), True, 0.1, "blocked"),
        (topics.RANGE, reading("front_left", None, "clear"), False, 0.6, "fault"),
        (topics.RANGE, reading("front_left", None, "fault", "no echo line"), True, 0.1, "fault"),
        (topics.BUMPER, msgspec.structs.replace(PUSHED, pressed=False), False, 0.1, "free"),
        (topics.BUMPER, PUSHED, True, 0.1, "blocked"),
        (topics.BUMPER, PUSHED, False, 0.6, "fault"),
    ],
)
def test_evidence_has_the_colour_of_its_state(
    topic: Topic[Any], sample: Any, blocks: bool, later: float, state: Any
) -> None:
    scene = Scene(BUMPED)
    rows = scene.on_sample(topic, sample, SECOND)
    way = verdict(0.0, "blocked", sample.sensor, "something is there", "turn left")
    rows += scene.on_sample(topics.GUARD, guard(way if blocks else verdict()), SECOND)
    rows += scene.update(SECOND + int(later * SECOND))
    red, green, blue = EVIDENCE[state]
    assert colour_of(seen_of(rows, sample.sensor)) >> 8 == red << 16 | green << 8 | blue


def judged(trouble: str) -> GuardState:
    """The guard's word on a rear sensor."""
    sensors = {"rear": SensorState(type=Ultrasonic.type_name(), trouble=Trouble(trouble))}
    return msgspec.structs.replace(guard(verdict()), sensors=sensors)


def rear_of(sample: Range | None = None) -> SensorEvidence:
    made = SensorEvidence("rear", ROBOT)
    assert sample is None or made.on_sample(topics.RANGE, sample, SECOND)
    return made


def test_a_sensor_that_the_guard_does_not_trust_is_a_fault() -> None:
    rear = rear_of(reading("rear", 2.0))
    assert rear.shown(SECOND)[:2] == ("free", "")
    rear.judge(judged("frozen"))
    assert rear.shown(SECOND)[:2] == ("fault", "frozen")
    assert rear_of().shown(SECOND).why == "not heard yet"


def test_silence_that_the_guard_does_not_believe_is_a_doubt() -> None:
    rear = rear_of(reading("rear", None, "clear"))
    rear.judge(judged("has not proved lately that it hears"))
    assert rear.shown(SECOND)[:2] == ("doubted", "has not proved lately that it hears")
    assert rear.shown(2 * SECOND)[:2] == ("fault", "silent for 1.0 s")
    assert not rear.on_sample(topics.BUMPER, msgspec.structs.replace(PUSHED, sensor="rear"), 2 * SECOND)


def test_a_cone_is_as_wide_as_its_sensor_hears_and_reaches_to_the_echo() -> None:
    sensors = stock("sim").sensors
    rear = msgspec.structs.replace(sensors["rear"], half_cone=0.4, reach=2.0)
    robot = msgspec.structs.replace(stock("sim"), sensors=sensors | {"rear": rear})
    for sensor, at_x, distance, half, length in (
        ("rear", -0.25, 0.5, 0.4, 0.5),
        ("rear", -0.25, None, 0.4, 2.0),
        ("rear", -0.25, 9.0, 0.4, 2.0),
        ("front_right", 0.25, None, math.radians(7.5), 4.0),
    ):
        heard = reading(sensor, distance, "clear" if distance is None else "echo")
        drawn = seen_of(Scene(robot).on_sample(topics.RANGE, heard, SECOND), sensor)
        at_y = 0.0 if sensor == "rear" else -0.15
        points = [(abs(x - at_x), y - at_y) for strip in strips_of(drawn) for x, y in strip[1:-1]]
        assert max(math.hypot(*point) for point in points) == pytest.approx(length)
        assert max(abs(math.atan2(y, x)) for x, y in points) == pytest.approx(half)


def test_a_sensor_of_another_type_is_drawn_by_its_own_evidence_and_told_in_its_words() -> None:
    scene = Scene(BUMPED)
    rows = scene.on_sample(topics.BUMPER, PUSHED, SECOND)
    [rim] = strips_of(seen_of(rows, "front"))
    assert np.hypot(*rim.T) == pytest.approx(0.3)
    assert rim.mean(axis=0)[0] > 0.2
    assert "front: near, pushed" in [what.text.as_arrow_array().to_pylist()[0] for path, what in rows if path == "log"]
    assert len(strips_of(seen_of(rows, "back"))) == 1, "one that was never heard shows what it senses"


def test_points_are_drawn_and_go(monkeypatch: pytest.MonkeyPatch) -> None:
    scene = Scene(BUMPED)
    drawn: list[list[Any]] = []
    for seen in ([[(1.0, 2.0)], [(1.0, 1.0), (2.0, 2.0)]], [], []):
        monkeypatch.setattr(Bumper, "evidence", lambda *_, seen=seen: Evidence(seen=seen))
        rows = scene.on_sample(topics.BUMPER, PUSHED, SECOND)
        points: list[Any] = [
            what for path, what in rows if path == "floor/evidence/front" and isinstance(what, rr.Points2D)
        ]
        drawn.append([each.positions.as_arrow_array().to_pylist() for each in points])
    assert drawn == [[[[1.0, 2.0]]], [[]], []]
