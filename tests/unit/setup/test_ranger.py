"""Ultrasonic sensors by a wall: drawn robots and wrong worlds, judged by the truth that was drawn."""

import math
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any, Final

import msgspec
import pytest

from giraff_core.kinematics.calibration import Calibration
from giraff_core.kinematics.pose import Pose
from giraff_core.robot import RobotConfig
from giraff_core.senses import HC_SR04, Ultrasonic
from giraff_guard.config import GuardConfig
from giraff_node.config.robot_file import load
from giraff_schemas.messages import Lease, Odometry, Range
from giraff_schemas.motion import Move, Turn
from giraff_setup.ultrasonic import stand
from giraff_setup.ultrasonic.calibrate import bounded, guide, placed, warning
from giraff_setup.ultrasonic.fit import Echo, SensorFit
from giraff_setup.ultrasonic.procedure import Measured, StoppedError, measure
from giraff_setup.ultrasonic.stand import Hearing
from giraff_sim.board import ROOT
from giraff_sim.world.room import Room
from giraff_sim.world.sonar import SonarFault
from giraff_tools.terminal.human import NobodyError
from tests.support.robots import ROBOT, ULTRASONIC
from tests.unit.cli.samples import at, odometry
from tests.unit.setup.walls import DrawnStand, TapePerson, bare_wall

_CALIBRATED: Final = '\n[robot.calibration]\ndate = "2026-11-25"\n'
_FARTHER: Final = "all the same"


def robot_file(folder: Path, more: str = _CALIBRATED) -> tuple[Path, RobotConfig]:
    path = folder / "robot.toml"
    path.write_text((ROOT / "deploy" / "robot.toml").read_text() + more)
    return path, load("robot", RobotConfig, {"GIRAFF_CONFIG": str(path)})


def sensors_in(path: Path) -> dict[str, Any]:
    sensors: dict[str, Any] = tomllib.loads(path.read_text(encoding="utf-8"))["robot"]["sensors"]
    return sensors


def require_true(path: Path, filed: RobotConfig, stand: DrawnStand) -> list[str]:
    """Compare with the truth what the file says anew; return the sensors of which it does."""
    found = [name for name, entry in sensors_in(path).items() if "scale" in entry]
    for name in found:
        pose, entry = filed.of(Ultrasonic)[name], sensors_in(path)[name]
        x = pose.x + stand.truth.sensor_xs[pose.index]
        yaw = pose.yaw + stand.truth.sensor_yaws[pose.index]
        assert entry["x"] == pytest.approx(x, abs=0.010), name
        assert math.remainder(entry["yaw"] - yaw, math.tau) == pytest.approx(0.0, abs=math.radians(2.0)), name
        assert entry["scale"] == pytest.approx(stand.truth.sonar_scales[pose.index], abs=0.0075), name
    return found


@pytest.mark.parametrize("seed", [0, 9])
def test_the_sensors_of_a_drawn_robot_are_found(seed: int, tmp_path: Path) -> None:
    path, filed = robot_file(tmp_path)
    before = path.read_bytes()
    drawn = DrawnStand(filed, seed, askew=math.radians(seed - 4.5))
    person = TapePerson(drawn, seed)
    assert guide(person, drawn, filed, path) == 0
    assert len(require_true(path, filed, drawn)) == 3, person.told
    assert [kept.read_bytes() for kept in tmp_path.glob("robot.toml.before-*")] == [before]
    assert sensors_in(path)["head"] == tomllib.loads(before.decode())["robot"]["sensors"]["head"]


def world(*, half: float = 5.0, person: tuple[float, float] | None = None) -> Room:
    room = bare_wall(0.9, half)
    if person is not None:
        room.add_post("person", *person, 0.2)
    return room


WORLDS: Final[dict[str, tuple[Callable[[], Room], str, int]]] = {
    "a person beside": (lambda: world(person=(0.5, 0.9)), "nearer than the wall|earlier to one side", 1),
    "a person before it": (lambda: world(person=(0.6, 0.2)), "nearer than the wall|do not grow|from where the file", 3),
    "a short wall": (lambda: world(half=0.3), "only|early to both sides|earlier to one side", 3),
    "a narrow wall": (lambda: world(half=0.5), "earl", 2),
}


@pytest.mark.parametrize("name", WORLDS)
def test_in_a_wrong_world_it_says_that_it_cannot_or_stays_within(name: str, tmp_path: Path) -> None:
    made, why, cannot = WORLDS[name]
    path, filed = robot_file(tmp_path)
    drawn = DrawnStand(filed, 2, room=made())
    person = TapePerson(drawn, 2)
    guide(person, drawn, filed, path)
    found = require_true(path, filed, drawn)
    told = "\n".join(person.told)
    assert len(found) <= 3 - cannot, told
    assert told.count("cannot be told") >= cannot, told
    assert any(word in told for word in why.split("|")), told


@pytest.mark.parametrize("fault", [SonarFault.DEAF, SonarFault.DEAD, SonarFault.WILD])
def test_a_faulty_sensor_stays_as_it_is_and_the_others_are_found(fault: SonarFault, tmp_path: Path) -> None:
    path, filed = robot_file(tmp_path)
    before = sensors_in(path)
    drawn = DrawnStand(filed, 4)
    drawn.sonars[1].fault = fault
    person = TapePerson(drawn, 4)
    assert guide(person, drawn, filed, path) == 0
    assert require_true(path, filed, drawn) == ["front_left", "rear"]
    assert sensors_in(path)["front_right"] == before["front_right"]
    assert any("front_right: cannot be told, and stays as it is" in words for words in person.told)


def sets(**fields: object) -> Callable[[DrawnStand], None]:
    """Return what gives these to a stand."""
    return lambda stand: stand.__dict__.update(fields)


NOTHING: Final[dict[str, tuple[Callable[[DrawnStand], None], dict[str, Any], str]]] = {
    "somebody drives": (
        sets(refusal="somebody drives; wait until it rests"),
        {},
        "somebody drives; wait until it rests. Nothing was written",
    ),
    "somebody drives while it listens": (sets(is_driven=True), {}, "the robot moved while it was to listen"),
    "motion holds its lease": (sets(holds_lease=True), {}, "still holds the lease. Nothing was written"),
    "not wanted": (sets(), {"Write front": ["no"]}, "not wanted. Nothing was written"),
    "the way is not free": (sets(), {"way free": ["maybe", "no"]}, "clear the way"),
    "closed stdin": (sets(), {"Write front": [NobodyError]}, "nobody answers. Nothing was written"),
    "Ctrl-C while it moves": (sets(interrupts=True), {}, ""),
    "Ctrl-C at the last question": (sets(), {"Write front": [KeyboardInterrupt]}, ""),
    "farther is not wanted": (sets(), {_FARTHER: ["no"] * 3}, "not wanted. Nothing was written"),
}


@pytest.mark.parametrize("name", NOTHING)
def test_nothing_is_written(name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    change, instead, said = NOTHING[name]
    path, filed = robot_file(tmp_path)
    before = path.read_bytes()
    drawn = next(stand for seed in range(200) if all(all_farther(stand := DrawnStand(filed, seed), filed)))
    change(drawn)
    if name.startswith("Ctrl-C"):
        with pytest.raises(KeyboardInterrupt):
            guide(TapePerson(drawn, 0, instead), drawn, filed, path)
    else:
        assert guide(TapePerson(drawn, 0, instead), drawn, filed, path) in {1, 2}
        assert said in capsys.readouterr().err
    assert path.read_bytes() == before
    assert list(tmp_path.iterdir()) == [path]
    if name in {"the way is not free", "somebody drives"}:
        assert not drawn.performed


def test_a_file_that_takes_no_sensors_is_refused_before_anything_moves(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path, filed = robot_file(tmp_path)
    path.write_text("[robot]\nsensors = 3\n", encoding="utf-8")
    drawn = DrawnStand(filed, 1)
    person = TapePerson(drawn)
    assert (guide(person, drawn, filed, path), person.asked, drawn.performed) == (2, [], [])
    assert "takes no [robot.sensors.front_left]" in capsys.readouterr().err


def all_farther(stand: DrawnStand, filed: RobotConfig) -> list[bool]:
    """Tell of each sensor whether its truth places obstacles clearly farther than the file."""
    truth = stand.truth
    return [
        truth.sensor_xs[pose.index] * math.copysign(1.0, math.cos(pose.yaw)) + truth.sonar_scales[pose.index] > 1.02
        for pose in filed.of(Ultrasonic).values()
    ]


def told(filed: RobotConfig, name: str, **fields: float) -> str:
    """Return what is asked before these changes, in m and rad, are written of one sensor."""
    pose = filed.sensors[name]
    after = {field: getattr(pose, field) + change for field, change in fields.items()}
    return warning(name, filed, placed(filed, name, after), GuardConfig())


def test_farther_needs_a_yes_of_its_own_that_names_the_millimetres() -> None:
    front, rear = (
        msgspec.structs.replace(ROBOT, sensors={name: Ultrasonic(index=0, x=x, y=0.0, yaw=yaw)})
        for name, x, yaw in (("front", 0.25, 0.0), ("rear", -0.25, math.pi))
    )
    assert not told(front, "front", x=-0.01, z=0.1)
    assert "1 m 10 mm farther than now" in told(front, "front", x=0.01)
    assert "1 m 20 mm farther than now" in told(front, "front", scale=0.02)
    assert "1 m 5 mm nearer than now, and up to 40 mm farther" in told(front, "front", x=-0.02, scale=0.015)
    assert not told(rear, "rear", x=0.01)
    assert "1 m 10 mm farther than now" in told(rear, "rear", x=-0.01)
    assert not told(ROBOT, "front_left", yaw=-math.radians(5.0))


def guard_offset(pose: Ultrasonic) -> float:
    """Return m that the guard adds to each range."""
    return pose.x * math.cos(pose.yaw) + pose.y * math.sin(pose.yaw)


@pytest.mark.parametrize(("yaw", "y", "farther"), [(5.0, 0.0, 12), (11.9, 0.0, 26), (11.9, 0.1, 46)])
@pytest.mark.parametrize("name", ["front_left", "front_right"])
def test_a_sensor_that_looks_or_sits_farther_out_needs_that_yes_too(
    name: str, yaw: float, y: float, farther: int
) -> None:
    before = ULTRASONIC[name]
    out = math.copysign(1.0, before.y)
    assert f"1 m {farther} mm farther than now" in told(ROBOT, name, yaw=out * math.radians(yaw), y=out * y)


def test_a_sensor_that_is_alone_at_its_side_afterwards_needs_that_yes_too() -> None:
    outer = msgspec.structs.replace(ULTRASONIC["front_left"], yaw=0.0, y=0.2, x=0.2)
    inner = msgspec.structs.replace(outer, index=1, y=0.1)
    filed = msgspec.structs.replace(ROBOT, sensors={"outer": outer, "inner": inner})
    assert "With outer so, inner will place an obstacle" in told(filed, "outer", y=-0.1001)


def test_a_sensor_that_the_guard_would_no_longer_count_stays_as_it_is() -> None:
    before = msgspec.structs.replace(ULTRASONIC["front_left"], yaw=math.radians(44.0))
    found = SensorFit(x=0.25, x_sd=0.001, scale=1.0, scale_sd=0.001, yaw=math.radians(46.0), yaw_sd=0.01)
    measured = bounded(before, Measured(before, found))
    assert measured.found is None
    assert "more than 45° aside" in measured.why


@pytest.mark.parametrize("seed", range(2))
def test_without_that_yes_nothing_is_placed_farther(seed: int, tmp_path: Path) -> None:
    path, filed = robot_file(tmp_path)
    drawn = DrawnStand(filed, seed)
    guide(TapePerson(drawn, seed, {_FARTHER: ["no"] * 3}), drawn, filed, path)
    for name, now in load("robot", RobotConfig, {"GIRAFF_CONFIG": str(path)}).of(Ultrasonic).items():
        was = filed.of(Ultrasonic)[name]
        for echo in (0.0, HC_SR04.reach):
            assert guard_offset(now) + now.scale * echo <= guard_offset(was) + was.scale * echo + 0.0006, name


def test_what_is_typed_wrong_is_asked_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path, filed = robot_file(tmp_path)
    monkeypatch.setenv("GIRAFF_ROBOT_SENSORS__REAR__YAW", "3.1")
    drawn = DrawnStand(filed, 1)
    instead = {
        "left wheel touches the floor:": ["nan", "900", "0.5"],
        "front_left: m left": ["twenty", "150", "0.152"],
        "front_left: m above": ["18 cm"],
    }
    person = TapePerson(drawn, 1, instead)
    assert guide(person, drawn, filed, path) == 0
    assert not any(person.instead.values())
    assert sensors_in(path)["front_left"]["y"] == pytest.approx(0.152)
    assert sensors_in(path)["front_left"]["z"] == pytest.approx(0.18)
    assert "still override it: GIRAFF_ROBOT_SENSORS__REAR__YAW" in person.told[-1]
    said = "\n".join(person.told)
    for words in ("nan: no number", "twenty: no number", "150 m is more than 0.1 m off", "more than 10° askew"):
        assert words in said


def test_a_sensor_that_looks_aside_is_left_alone_and_without_rear_ones_nothing_turns_round() -> None:
    filed = msgspec.structs.replace(ROBOT, calibration=Calibration(date="2026-11-25"))
    ahead, aside = filed.sensors["front_left"], msgspec.structs.replace(filed.sensors["rear"], yaw=math.pi / 2)
    filed = msgspec.structs.replace(filed, sensors={"front": ahead, "aside": aside})
    drawn = DrawnStand(filed, 1)
    told = measure(TapePerson(drawn, 1), drawn, filed)
    assert told["front"].found is not None
    assert "looks aside" in told["aside"].why
    assert sum(step.distance for step in drawn.performed if isinstance(step, Move)) == pytest.approx(-0.8)
    assert sum(step.angle for step in drawn.performed if isinstance(step, Turn)) == pytest.approx(0.0)


def test_an_uncalibrated_robot_is_sent_to_calibrate_odometry(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path, filed = robot_file(tmp_path, "")
    drawn = DrawnStand(filed, 1, "uncalibrated")
    assert guide(TapePerson(drawn), drawn, filed, path) == 1
    assert "call `giraff calibrate odometry` first" in capsys.readouterr().err
    assert not drawn.performed


def turned(ns: int, yaw: float, breaks: int = 0) -> Odometry:
    return msgspec.structs.replace(odometry(ns, 1.0, 0.0, yaw), instance="o", breaks=breaks)


def test_a_ping_has_the_raw_echo_and_the_pose_of_its_moment() -> None:
    hearing = Hearing()
    hearing.on_sample(turned(1_000, 0.0))
    hearing.on_sample(Range(sensor="rear", state="echo", range=9.0, echo_us=5800, tick=at(1_500)))
    assert hearing.echoes == []
    hearing.on_sample(turned(2_000, 0.2))
    assert hearing.echoes == [Echo("rear", 1.0, Pose(1.0, 0.0, 0.1))]
    hearing.on_sample(Lease(instance="g", holder="m-1", operator="motion", counter=1))
    assert hearing.motion_holds_lease
    assert not hearing.fault
    hearing.on_sample(turned(3_000, 0.2, breaks=1))
    assert "begin again" in hearing.fault


def test_ctrl_c_cancels_the_motion_and_waits_for_its_end(monkeypatch: pytest.MonkeyPatch) -> None:
    said: list[str] = []

    class Client:
        has_asked = True

        def __init__(self, *_: object) -> None: ...

        def turn(self, now: float) -> object:
            del now
            said.append("turn")
            if len(said) == 2:
                raise KeyboardInterrupt
            return object() if len(said) > 4 else None

        def cancel(self, now: float) -> None:
            del now
            said.append("cancel")

        def close(self) -> None:
            said.append("close")

    class Connection:
        session, robot = None, "r"

        def subscribe(self, topic: object) -> None: ...

        def dispatch(self, listener: object) -> None: ...

    monkeypatch.setattr(stand, "MotionClient", Client)
    one = stand.NetworkStand(Connection())  # type: ignore[arg-type]
    with pytest.raises(KeyboardInterrupt):
        one.perform([Move(distance=-0.4)])
    assert said == ["turn", "turn", "cancel", "turn", "turn", "close"]
    monkeypatch.setattr(stand, "_PATIENCE", 0.0)
    with pytest.raises(StoppedError, match="odometry is not heard"):
        one.place()
