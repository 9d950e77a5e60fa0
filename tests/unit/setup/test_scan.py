"""A laser scanner, found by motion and before a wall: drawn mounts and wrong worlds, judged by what was drawn."""

import math
import tomllib
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from random import Random
from typing import Any, Final

import numpy as np
import pytest

from giraff_core.kinematics.pose import Pose
from giraff_core.robot import RobotConfig
from giraff_core.senses import LaserScanner
from giraff_maps.scan.match import Field, cloud_of, match
from giraff_node.config.robot_file import load
from giraff_schemas.topics import SCAN
from giraff_schemas.trouble import Trouble
from giraff_setup.scan.calibrate import guide
from giraff_setup.scan.fit import Mount
from giraff_setup.scan.procedure import Surveyed, check, survey
from giraff_setup.scan.stand import ScanStand
from giraff_sim.board import ROOT
from giraff_tools.terminal.human import NobodyError
from tests.support.robots import ROBOT
from tests.unit.setup.scans import DARK, LONG, NARROW, DrawnScanned, box, posts
from tests.unit.setup.walls import Answer, TapePerson

_TABLE: Final = '\n[robot.sensors.laser]\ntype = "ld19"  # its place by ruler\nx = -0.1\ny = 0.0\nz = 0.2\nyaw = 0.1\n'
_POSTS: Final = -1.9, 2.0
"""rad in the scanner's frame."""
_PLATE: Final = [(-0.2, -0.15, -0.2, 0.15)]
"""A flat part of the robot behind the scanner, wide as a wall."""
_NO_WALL: Final[Mapping[str, Sequence[Answer]]] = {"Check it": ["no"]}


def drawn(folder: Path, seed: int, bias: float = 0.015, more: str = "") -> tuple[Path, RobotConfig, DrawnScanned]:
    """Return a robot file, and a robot whose scanner sits elsewhere, with such a bias at most (m).

    `more`: lines of the scanner's table.
    """
    path, chance = folder / "robot.toml", Random(seed)
    path.write_text((ROOT / "deploy" / "robot.toml").read_text() + _TABLE + more)
    filed = load("robot", RobotConfig, {"GIRAFF_CONFIG": str(path)})
    mount = Pose(chance.uniform(-0.25, 0.2), chance.uniform(-0.15, 0.15), chance.uniform(-0.2, 0.4))
    return path, filed, DrawnScanned(filed.of(LaserScanner)["laser"], seed, mount, chance.uniform(-bias, bias))


def person(
    robot: DrawnScanned, instead: Mapping[str, Sequence[Answer]], distances: Sequence[Answer] = ("0.9", "0.9")
) -> TapePerson:
    return TapePerson(robot, 0, {**instead, "middle between": distances})


def fields(path: Path) -> dict[str, Any]:
    laser: dict[str, Any] = tomllib.loads(path.read_text(encoding="utf-8"))["robot"]["sensors"]["laser"]
    return laser


def off(found: Mount, robot: DrawnScanned) -> tuple[float, float, float]:
    """Return m, m, degrees off the truth."""
    x, y, yaw = robot.mount
    return abs(found.x - x), abs(found.y - y), abs(math.degrees(math.remainder(found.yaw - yaw, math.tau)))


def require_true(path: Path, robot: DrawnScanned) -> None:
    laser = fields(path)
    x, y, yaw = off(Mount(laser["x"], laser["y"], laser["yaw"], 0.0, 0.0, 0.0), robot)
    assert (x <= 0.004, y <= 0.004, yaw <= 1.0) == (True, True, True), (x, y, yaw)


def by_motion(folder: Path, seed: int) -> tuple[Surveyed, tuple[float, float, float]]:
    """Return what is found by motion, and m, m, degrees by which it is off."""
    _, filed, robot = drawn(folder, seed)
    robot.posts = _PLATE if seed % 2 else []
    found = survey(person(robot, {}), robot, filed.of(LaserScanner), filed.footprint_radius)
    return found, off(found.mount, robot)


def by_the_wall(
    folder: Path, seed: int, own: Sequence[float] = ()
) -> tuple[tuple[float, float, float], float | None, DrawnScanned]:
    """Return m, m, degrees by which the wall's mount is off, and the bias of the ranges that it tells."""
    _, filed, robot = drawn(folder, seed, bias=0.045)
    robot.posts, robot.is_blocked = posts(*own), seed == 2
    rough = Mount(robot.mount.x + 0.004, robot.mount.y - 0.004, robot.mount.yaw + 0.01, 0.0, 0.0, 0.0)
    arcs = [(bearing - 0.2, bearing + 0.2) for bearing in own]
    before = filed.of(LaserScanner)["laser"]
    found = check(person(robot, {}), robot, before, Surveyed("laser", rough, upside_down=False, own=arcs, words=[]))
    assert found is not None
    return off(found[0], robot), found[1], robot


@pytest.mark.parametrize("seed", range(2, 4))
def test_the_mount_is_found_by_motion(seed: int, tmp_path: Path) -> None:
    found, (x, y, yaw) = by_motion(tmp_path, seed)
    assert (x <= 0.004, y <= 0.004, yaw <= 1.0) == (True, True, True), (x, y, yaw)
    assert (found.upside_down, len(found.own), found.words) == (False, seed % 2, [])


@pytest.mark.parametrize("seed", range(3))
def test_a_step_in_a_wall_before_it_and_behind_it_tells_mount_and_bias(seed: int, tmp_path: Path) -> None:
    (x, y, yaw), bias, robot = by_the_wall(tmp_path, seed)
    assert (x <= 0.010, y <= 0.015, yaw <= 2.0) == (True, True, True), (x, y, yaw)
    assert bias == pytest.approx(robot.bias, abs=0.010)


def test_a_robot_whose_mast_hides_its_back_is_measured_before_the_wall_alone(tmp_path: Path) -> None:
    (x, _, _), bias, robot = by_the_wall(tmp_path, 0, [math.pi])
    assert bias is None
    assert x == pytest.approx(abs(robot.bias), abs=0.012)
    assert not robot.performed


@pytest.mark.parametrize("seed", range(2))
def test_what_was_found_is_written_and_told_beside_the_wall(seed: int, tmp_path: Path) -> None:
    path, filed, robot = drawn(tmp_path, seed)
    before, documents = path.read_bytes(), list[Any]()
    robot.posts, robot.bias = posts(*_POSTS), 0.04
    human = person(robot, {})
    assert guide(human, robot, filed, path, documents.append) == 0
    require_true(path, robot)
    laser, told = fields(path), "\n".join(human.told)
    assert (laser["upside_down"], len(laser["own"])) == (False, 2), told
    for (begin, end), bearing in zip(laser["own"], _POSTS, strict=True):
        corners = [bearing + math.remainder(math.atan2(y, x) - bearing, math.tau) for x, y, _, _ in posts(bearing)]
        assert 0.0 < min(corners) - begin < 0.03, told
        assert 0.0 < end - max(corners) < 0.03, told
    [kept] = tmp_path.glob("robot.toml.before-*")
    assert kept.read_bytes() == before
    table = {name: laser[name] for name in ("x", "y", "yaw", "upside_down", "own")}
    assert documents == [{"robot_file": str(path), "tables": {"robot.sensors.laser": table}, "as_before": str(kept)}]
    assert load("robot", RobotConfig, {"GIRAFF_CONFIG": str(path)}).of(LaserScanner)["laser"].own is not None
    assert "-0.100 m" in told
    [bias] = [words for words in human.told if "mm too long" in words]
    assert float(bias.partition("ranges are ")[2].partition(" mm")[0]) == pytest.approx(40.0, abs=8.0)


@pytest.mark.parametrize(("seed", "before", "now"), [(0, "false", "upside down"), (1, "true", "the right way up")])
def test_one_that_hangs_the_other_way_and_looks_backward_is_named(
    seed: int, before: str, now: str, tmp_path: Path
) -> None:
    path, filed, robot = drawn(tmp_path, seed, more=f"upside_down = {before}\n")
    robot.room, robot.is_mirrored = LONG, True
    robot.mount = robot.mount._replace(yaw=math.pi + 0.2)
    human = person(robot, {})
    assert guide(human, robot, filed, path) == 0
    require_true(path, robot)
    assert fields(path)["upside_down"] is (before == "false")
    told = "\n".join(human.told)
    assert f"hangs {now}, other than the file says" in told
    assert "turned by 180 degrees" in told


def sets(**values: object) -> Callable[[DrawnScanned], None]:
    """Return what gives these to a robot."""
    return lambda robot: robot.__dict__.update(values)


NOTHING: Final[dict[str, tuple[Callable[[DrawnScanned], None], Mapping[str, Sequence[Answer]], str]]] = {
    "too little room": (sets(room=NARROW), {}, "0.6 m are free ahead by the scan, and it needs 1.5 m"),
    "services that go by another file": (sets(turned_since=0.1), {}, "goes by another yaw or upside_down of laser"),
    "the way is not free": (sets(), {"ahead of it free": ["no"]}, "clear the way"),
    "a dark room": (sets(room=DARK), {}, "only 0 of 450 rays have an echo"),
    "a silent scanner": (sets(silent_after=0), {}, "the laser scanner is silent"),
    "a scanner that stops in the middle": (sets(silent_after=20), {}, "the laser scanner is silent"),
    "a scanner with a fault": (sets(trouble=Trouble("its motor is held", "free it")), {}, "its motor is held; free it"),
    "a scanner that is stuck": (sets(is_stuck=True), {}, "which way the robot turned"),
    "a smooth corridor": (
        sets(room=box(-20.0, -0.8, 20.0, 0.9)),
        {},
        "m by the walls; take a room with more furniture",
    ),
    "another scanner": (sets(name="head"), {}, "head is heard, and the robot file has no [robot.sensors.head] of the"),
    "somebody drives": (sets(is_driven=True), {}, "the robot moved while it was to rest"),
    "motion holds its lease": (sets(holds_lease=True), _NO_WALL, "still holds the lease"),
    "not wanted": (sets(), {**_NO_WALL, "Write laser": ["no"]}, "not wanted"),
    "nobody": (sets(), {**_NO_WALL, "Write laser": [NobodyError]}, "nobody answers"),
}
_MOVES: Final = {
    *("a scanner that stops in the middle", "a scanner that is stuck", "a smooth corridor", "motion holds its lease"),
}


@pytest.mark.parametrize("name", NOTHING)
def test_nothing_is_written(name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    change, instead, said = NOTHING[name]
    path, filed, robot = drawn(tmp_path, 0)
    change(robot)
    before = path.read_bytes()
    assert guide(person(robot, instead), robot, filed, path) in {1, 2}
    told = capsys.readouterr().err
    assert said in told
    assert "Nothing was written" in told
    assert path.read_bytes() == before
    assert list(tmp_path.iterdir()) == [path]
    assert bool(robot.performed) == (name in _MOVES or "Write laser" in instead)


@pytest.mark.parametrize("answer", ["no", "yes"])
def test_a_wall_that_disagrees_needs_a_yes_of_its_own(answer: str, tmp_path: Path) -> None:
    path, filed, robot = drawn(tmp_path, 1)
    before = path.read_bytes()
    human = person(robot, {"disagree about x; measure": [answer]}, ["thirty", "0.95", "0.90"])
    assert guide(human, robot, filed, path) == (0 if answer == "yes" else 1)
    assert not human.instead["disagree about x; measure"]
    assert (path.read_bytes() == before) == (answer == "no")


def test_without_a_scanner_in_the_file_nothing_moves(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path, _, robot = drawn(tmp_path, 1)
    assert guide(person(robot, {}), robot, ROBOT, path) == 2
    assert 'write [robot.sensors.laser] with type = "ld19"' in capsys.readouterr().err
    assert not robot.performed


def test_a_wall_is_matched_with_the_same_face_of_it() -> None:
    """A thin wall was seen from both sides, and the guess lies nearer to its other face."""
    angles = np.linspace(-1.0, 1.0, 200)
    seen = cloud_of(angles, 2.0 / np.cos(angles))
    field = Field([seen, seen.placed((4.12, 0.0, math.pi))])
    found = match(field, seen, (0.08, 0.0, 0.0), (0.1, 0.001, 0.001))
    assert found.pose[0] == pytest.approx(0.0, abs=0.005)
    assert found.share > 0.9


def test_turns_that_may_have_begun_before_are_left_out(tmp_path: Path) -> None:
    scans = drawn(tmp_path, 1)[2].scan(6)
    waiting = list(scans)

    class Connection:
        def subscribe(self, topic: object) -> None: ...

        def dispatch(self, listener: ScanStand) -> None:
            for _ in range(2):
                listener.on_sample(SCAN, "scan/laser", waiting.pop(0), 0)

    assert ScanStand(Connection()).scan(1) == [scans[4]]  # type: ignore[arg-type]
