"""`giraff node`, `graph`, `frames` and `top` beside a running robot."""

import math
import re
import signal
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

import psutil
import pytest

from giraff_schemas.messages import Battery
from giraff_schemas.topics import BATTERY
from tests.functional.one_robot.answers import Holds, Scene, answers, document, in_json
from tests.support.desk import Desk, Done
from tests.support.elsewhere import GIRAFF, line_that
from tests.support.process_robot import SERVICES, ProcessRobot
from tests.support.robots import ULTRASONIC
from tests.support.talker import INSTANCE, talker
from tests.support.terminals import screen

EDGES = {
    ("base", "tick", "guard"),
    ("base", "tick", "joystick"),
    ("base", "tick", "ranger"),
    ("base", "wheels", "guard"),
    ("base", "wheels", "odometry"),
    ("base", "base", ""),
    ("base", "battery", ""),
    ("base", "estop", ""),
    ("guard", "cmd_vel", "base"),
    ("guard", "lease", "joystick"),
    ("guard", "guard", ""),
    ("joystick", "cmd_vel/joystick", "guard"),
    ("joystick", "tilt", ""),
    ("odometry", "odom", ""),
    ("ranger", "range/front_left", "guard"),
    ("ranger", "range/front_left", "odometry"),
    ("ranger", "range/front_right", "guard"),
    ("ranger", "range/front_right", "odometry"),
    ("ranger", "range/rear", "guard"),
    ("ranger", "range/rear", "odometry"),
}


def are_well(rows: Any) -> bool:
    told = [row["service"] for row in rows if row["health"] and row["health"]["ok"]]
    return told == sorted(SERVICES)


def is_whole_graph(drawn: Any) -> bool:
    edges = {(edge["source"], edge["key"], edge["target"]) for edge in drawn["edges"]}
    return (set(drawn["nodes"]), edges) == (set(SERVICES), EDGES)


def is_whole_top(report: Any) -> bool:
    told = [work["service"] for work in report["services"] if work["cpu"]]
    flowing = {stream["key"] for stream in report["topics"] if stream["hz"]}
    return told == sorted(SERVICES) and flowing >= {"odom", "cmd_vel"}


def tells(*patterns: str) -> Holds:
    """Each somewhere in what people read."""
    return lambda done: all(re.search(each, done.stdout, re.MULTILINE) for each in patterns)


MOST_THREADS: Final[Mapping[str, int]] = {"base": 10, "guard": 8, "joystick": 8, "ranger": 10, "odometry": 12}
"""Python's own, by service: the loop, one for each subscriber and queryable, one for each file that is kept."""
RECEIVING: Final = 16
"""Zenoh's, in each, at least: as many links may die at one moment, and none of the others waits for them."""


def threads_of(pid: int) -> list[str]:
    return [name.read_text().strip() for name in Path(f"/proc/{pid}/task").glob("*/comm")]


FRAMES: Final = 1 + len(ULTRASONIC) + 1
"""In others: the robot, its sensors, its laser."""
ASKED: Final[Mapping[str, Holds]] = {
    "node list --json": in_json(are_well),
    "node list": lambda done: done.returncode == 0,
    "node info base --json": in_json(len),
    "node info guard": tells(r"publishes   cmd_vel -> base$", r"listens to  cmd_vel/\* <- joystick$"),
    "graph --for 0.3 --json": in_json(is_whole_graph),
    "graph --for 0.3 --dot": lambda done: done.stdout.count(" -> ") >= len(EDGES),
    "graph --for 0.3": tells(r"tick +-> guard, joystick, ranger$", r"odom +-> nobody that says so$"),
    "frames --json": in_json(lambda found: len(found["frames"]) == FRAMES),
    "frames": lambda done: done.stdout.count("\n") == 1 + FRAMES,
    "frames --dot": lambda done: done.stdout.count(" -> ") == FRAMES,
    "frames --from laser --to range_rear_link --json": in_json(lambda pose: pose["fixed"]),
    "frames --from laser --to odom": lambda done: done.returncode == 0,
}


def losses_and_silence(desk: Desk) -> Done:
    """The lines up to the one that tells of both."""
    seqs = [seq for seq in range(60) if seq not in (20, 21, 22)]
    words = ("top", "--robot", "sim-lossy")
    with talker(desk.rendezvous, "sim-lossy") as robot, desk.running(*words) as process:
        robot.say(BATTERY, Battery(voltage=24.0), seqs, 20.0)
        lost = line_that(process, lambda line: line.rstrip().endswith("| base - | lost 3 | slow: none"))
        silent = line_that(process, lambda line: line.rstrip().endswith("| base - | lost 3 | slow: battery - Hz"))
        process.send_signal(signal.SIGINT)
        return Done(words, process.wait(60.0), lost + silent)


def list_of_a_mute_one(desk: Desk) -> Done:
    with talker(desk.rendezvous, "sim-mute"):
        return desk.run("node", "list", "--robot", "sim-mute")


def frames_of_which_nobody_tells(desk: Desk) -> Done:
    with talker(desk.rendezvous, "sim-nowhere"):
        return desk.run("frames", "--robot", "sim-nowhere")


SCENES: Final[Mapping[str, Scene]] = {
    "losses and silence": losses_and_silence,
    "mute": list_of_a_mute_one,
    "nowhere": frames_of_which_nobody_tells,
}


@pytest.fixture(scope="module")
def told(robot: ProcessRobot, desk: Desk) -> dict[str, Done]:
    """All that is only looked at."""
    rows = [rf"^{service} +\S+ +{robot.pid(service)} +\d+\.\d % +\d+ MB  \S" for service in SERVICES]
    top = {
        "top --once --json": in_json(is_whole_top),
        "top --once": tells(*rows, r"^sim-test  ", r"^odom +odometry +\d+\.\d +100\.0 +\d+ +\d+ +\d+ +"),
    }
    return answers(desk, top | dict(ASKED), SCENES)


def test_list_tells_where_each_service_runs(robot: ProcessRobot, told: Mapping[str, Done]) -> None:
    rows = document(told["node list --json"])
    assert [row["service"] for row in rows] == sorted(SERVICES)
    for row in rows:
        assert row["health"]["pid"] == robot.pid(row["service"])
    for service in SERVICES:
        row = rf"^{service} +[0-9a-f]{{16}} +\S+ +{robot.pid(service)} +"
        assert re.search(row, told["node list"].stdout, re.MULTILINE)


def test_info_tells_what_a_service_says_and_to_whom(robot: ProcessRobot, desk: Desk, told: Mapping[str, Done]) -> None:
    [row] = document(told["node info base --json"])
    health = row["health"]
    assert set(health["publishes"]) == {"tick", "wheels", "base", "estop", "battery"}
    assert set(health["subscribes"]) == {"cmd_vel", "visual_odom"}
    assert {"estop/engage", "estop/reset"} <= set(health["answers"])
    assert health["cpu_time"] > 0.0
    assert 10e6 < health["rss_bytes"] < 200e6
    assert f"pid {robot.pid('guard')}," in told["node info guard"].stdout
    assert desk.json_until(len, "node", "info", row["instance"])[0]["service"] == "base"


def test_a_service_that_is_not_well_or_does_not_answer_shows(
    robot: ProcessRobot, desk: Desk, told: Mapping[str, Done]
) -> None:
    robot.simulator.unplug("ranger")
    try:
        fault = re.compile(r"^ranger .*ports/ranger: ", re.MULTILINE)
        done = desk.until(lambda done: fault.search(done.stdout), "node", "list")
    finally:
        robot.simulator.plug("ranger")
    assert done.returncode == 1
    desk.until(lambda done: done.returncode == 0, "node", "info", "ranger")
    done = told["mute"]
    assert done.returncode == 1
    assert re.search(rf"^base +{INSTANCE} .* does not answer", done.stdout, re.MULTILINE)


def test_the_graph_has_every_edge(told: Mapping[str, Done]) -> None:
    """Those of --json are judged where they are asked for."""
    document(told["graph --for 0.3 --json"])
    dot = told["graph --for 0.3 --dot"].stdout
    assert dot.startswith('digraph "sim-test" {\n')
    arrows = re.findall(r'^  "(\S+)" -> "(\S+)" \[label="(\S+)"\];$', dot, re.MULTILINE)
    assert {(source, key, target) for source, target, key in arrows} == {edge for edge in EDGES if edge[2]}
    assert '"odometry" -> "/odom" [style=dashed];' in dot
    assert '"base" -> "/base" [style=dashed];' in dot


def test_the_tree_goes_from_odom_to_the_sensors(told: Mapping[str, Done]) -> None:
    found = document(told["frames --json"])
    places = {frame["child"]: frame for frame in found["frames"]}
    assert set(places) == {"base_link", "laser", "range_front_left_link", "range_front_right_link", "range_rear_link"}
    laser = places["laser"]
    assert (laser["parent"], laser["x"], laser["z"], laser["pitch"], laser["fixed"]) == (
        "base_link",
        -0.115,
        0.226,
        0.1,
        True,
    )
    assert (places["base_link"]["parent"], places["base_link"]["fixed"]) == ("odom", False)
    for sensor, pose in ULTRASONIC.items():
        frame = places[f"range_{sensor}_link"]
        assert (frame["parent"], frame["fixed"]) == ("base_link", True)
        assert (frame["x"], frame["y"], frame["yaw"]) == pytest.approx((pose.x, pose.y, pose.yaw))
    assert found["faults"] == []


def test_the_pose_of_one_frame_is_told_in_another(told: Mapping[str, Done]) -> None:
    """The rear sensor looks back."""
    pose = document(told["frames --from laser --to range_rear_link --json"])
    assert (pose["parent"], pose["child"]) == ("range_rear_link", "laser")
    found = [pose[name] for name in ("x", "y", "z", "roll", "pitch")]
    assert found == pytest.approx([-0.135, 0.0, 0.226, 0.0, 0.1])
    assert abs(pose["yaw"]) == pytest.approx(math.pi)
    text = told["frames --from laser --to odom"].stdout
    assert re.match(r"laser in odom, now\nx +-?\d\.\d{3} m\n", text)  # wherever the robot has been driven to
    assert "\npitch   0.1000 rad     5.73°\n" in text


def test_it_is_drawn(told: Mapping[str, Done]) -> None:
    text = told["frames"].stdout
    assert re.match(r"odom\n└── base_link  x -?\d\.\d{3} m, y -?\d\.\d{3} m, yaw ", text)
    assert re.search(r"^    ├── laser  x -0.115 m, y 0.000 m, z 0.226 m, pitch 5.7°, yaw 0.0°$", text, re.MULTILINE)
    assert re.search(r"^    └── range_rear_link  x -0.250 m, y 0.000 m, yaw 180.0°$", text, re.MULTILINE)
    drawn = told["frames --dot"].stdout
    assert '"odom" -> "base_link" [label=' in drawn
    assert '"base_link" -> "range_rear_link" [label="x -0.250 m, y 0.000 m, yaw 180.0°"];' in drawn


def test_a_robot_of_which_nobody_tells_is_named(told: Mapping[str, Done]) -> None:
    done = told["nowhere"]
    assert (done.returncode, done.stdout) == (2, "")
    [line] = done.stderr.splitlines()
    assert "nobody tells where the frames of sim-nowhere are" in line


def test_top_has_services_hosts_and_topics(robot: ProcessRobot, told: Mapping[str, Done]) -> None:
    report = document(told["top --once --json"])
    for work in report["services"]:
        process = psutil.Process(robot.pid(work["service"]))
        assert work["pid"] == process.pid
        assert work["rss_bytes"] == pytest.approx(process.memory_info().rss, rel=0.1)
    [[cpu, rss]] = report["hosts"].values()
    assert cpu == pytest.approx(sum(work["cpu"] for work in report["services"]))
    assert rss == sum(work["rss_bytes"] for work in report["services"])
    [odom] = [stream for stream in report["topics"] if stream["key"] == "odom"]
    assert odom["by"] == "odometry"


def test_a_service_has_few_threads(robot: ProcessRobot) -> None:
    for service in SERVICES:
        names = threads_of(robot.pid(service))
        assert sum(name.startswith("rx-") for name in names) >= RECEIVING, service
        of_python = [name for name in names if name.startswith("python")]
        assert len(of_python) <= MOST_THREADS[service], (
            f"{service}: a subscriber or a queryable more is a thread more; let two share one, or raise the limit"
        )


def test_losses_and_silence_show(told: Mapping[str, Done]) -> None:
    """The lines themselves are judged where they are read."""
    assert told["losses and silence"].returncode == 0


def test_a_terminal_shows_it_and_is_given_back(desk: Desk, tmp_path: Path) -> None:
    environment = {**desk.environment, "TERM": "xterm-256color"}
    with screen([str(GIRAFF), "top"], tmp_path / "top.err", environment) as shown:
        shown.wait_for("odometry", 60.0)
        shown.wait_for("100.0", 60.0)
        shown.type(b"\x03")
        assert shown.ended(60.0) == 0
        assert shown.is_restored()
    assert (tmp_path / "top.err").read_text() == ""
