"""`giraff node` and `giraff graph` beside a running robot."""

from __future__ import annotations

import re

from tests.support.desk import Desk
from tests.support.process_robot import SERVICES, ProcessRobot
from tests.support.talker import INSTANCE, talker

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
    ("ranger", "range/front_right", "guard"),
    ("ranger", "range/rear", "guard"),
}


def test_list_tells_where_each_service_runs(robot: ProcessRobot, desk: Desk) -> None:
    rows = desk.json("node", "list")
    assert [row["service"] for row in rows] == sorted(SERVICES)
    for row in rows:
        assert row["health"]["pid"] == robot.pid(row["service"])
        assert row["health"]["ok"]
    done = desk.run("node", "list")
    assert done.returncode == 0
    for service in SERVICES:
        assert re.search(rf"^{service} +[0-9a-f]{{16}} +\S+ +{robot.pid(service)} +", done.stdout, re.MULTILINE)


def test_info_tells_what_a_service_says_and_to_whom(robot: ProcessRobot, desk: Desk) -> None:
    [row] = desk.json("node", "info", "base")
    health = row["health"]
    assert set(health["publishes"]) == {"tick", "wheels", "base", "estop", "battery"}
    assert health["subscribes"] == ["cmd_vel"]
    assert {"estop/engage", "estop/reset"} <= set(health["answers"])
    assert health["cpu_time"] > 0.0
    assert 10e6 < health["rss_bytes"] < 200e6
    text = desk.run("node", "info", "guard").stdout
    assert f"pid {robot.pid('guard')}," in text
    assert "publishes   cmd_vel -> base\n" in text
    assert "listens to  cmd_vel/* <- joystick\n" in text
    assert desk.json("node", "info", row["instance"])[0]["service"] == "base"


def test_a_service_that_is_not_there_is_told_with_those_that_are(desk: Desk) -> None:
    done = desk.run("node", "info", "gard")
    assert (done.returncode, done.stdout) == (2, "")
    [line] = done.stderr.splitlines()
    assert line.endswith(
        "sim-test has no service 'gard' on the network; there are: base, guard, joystick, odometry, ranger"
    )


def test_a_service_that_is_not_well_or_does_not_answer_shows(robot: ProcessRobot, desk: Desk) -> None:
    robot.simulator.unplug("ranger")
    try:
        robot.wait("the ranger's fault", lambda: desk.run("node", "info", "ranger").returncode == 1, 20.0)
        done = desk.run("node", "list")
    finally:
        robot.simulator.plug("ranger")
    assert done.returncode == 1
    assert re.search(r"^ranger .*ports/ranger: ", done.stdout, re.MULTILINE)
    robot.wait("the ranger's recovery", lambda: desk.run("node", "info", "ranger").returncode == 0, 20.0)
    with talker(desk.rendezvous, "sim-mute"):
        done = desk.run("node", "list", "--robot", "sim-mute")
    assert done.returncode == 1
    assert re.search(rf"^base +{INSTANCE} .* does not answer", done.stdout, re.MULTILINE)


def test_the_graph_has_every_edge(desk: Desk) -> None:
    drawn = desk.json("graph")
    assert set(drawn["nodes"]) == set(SERVICES)
    assert {(edge["source"], edge["key"], edge["target"]) for edge in drawn["edges"]} == EDGES
    dot = desk.run("graph", "--dot").stdout
    assert dot.startswith('digraph "sim-test" {\n')
    arrows = re.findall(r'^  "(\S+)" -> "(\S+)" \[label="(\S+)"\];$', dot, re.MULTILINE)
    assert {(source, key, target) for source, target, key in arrows} == {edge for edge in EDGES if edge[2]}
    assert '"odometry" -> "/odom" [style=dashed];' in dot
    assert '"base" -> "/base" [style=dashed];' in dot
    text = desk.run("graph").stdout
    assert re.search(r"tick +-> guard, joystick, ranger$", text, re.MULTILINE)
    assert re.search(r"odom +-> nobody that says so$", text, re.MULTILINE)
