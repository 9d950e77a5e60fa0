"""`giraff top` beside a running robot."""

from __future__ import annotations

import json
import re
import signal
import time
from pathlib import Path

import psutil
import pytest

from giraff_schemas.messages import Battery
from giraff_schemas.topics import BATTERY
from tests.support.desk import Desk
from tests.support.elsewhere import GIRAFF
from tests.support.process_robot import SERVICES, ProcessRobot
from tests.support.talker import talker
from tests.support.terminals import screen


def test_once_has_services_hosts_and_topics(robot: ProcessRobot, desk: Desk) -> None:
    before = {service: sum(psutil.Process(robot.pid(service)).cpu_times()[:2]) for service in SERVICES}
    began = time.monotonic()
    report = desk.json("top", "--once")
    took = time.monotonic() - began
    assert [work["service"] for work in report["services"]] == sorted(SERVICES)
    for work in report["services"]:
        process = psutil.Process(robot.pid(work["service"]))
        assert work["pid"] == process.pid
        assert work["rss_bytes"] == pytest.approx(process.memory_info().rss, rel=0.1)
        spent = (sum(process.cpu_times()[:2]) - before[work["service"]]) / took
        assert work["cpu"] == pytest.approx(spent, rel=0.6, abs=0.03)  # not quite of the same time
    [[cpu, rss]] = report["hosts"].values()
    assert cpu == pytest.approx(sum(work["cpu"] for work in report["services"]))
    assert rss == sum(work["rss_bytes"] for work in report["services"])
    topics = {stream["key"]: stream for stream in report["topics"]}
    assert topics["odom"]["by"] == "odometry"
    assert topics["cmd_vel"]["hz"] == pytest.approx(50.0, rel=0.2)
    text = desk.run("top", "--once").stdout
    assert text.startswith("sim-test  ")
    for service in SERVICES:
        assert re.search(rf"^{service} +\S+ +{robot.pid(service)} +\d+\.\d % +\d+ MB  \S", text, re.MULTILINE)
    assert re.search(r"^odom +odometry +\d+\.\d +100\.0 +\d+ +\d+ +\d+ +", text, re.MULTILINE)


def test_lines_come_once_a_second_and_end_in_time(desk: Desk) -> None:
    done = desk.run("top", "--for", "3.5", "--json")
    assert (done.returncode, done.stderr) == (0, "")
    told = [json.loads(line) for line in done.stdout.splitlines()]
    assert [int(report["elapsed"]) for report in told] == [0, 1, 2, 3]
    assert all(report["robot"] == "sim-test" for report in told)


def test_losses_and_silence_show(desk: Desk) -> None:
    seqs = [seq for seq in range(60) if seq not in (20, 21, 22)]
    with talker(desk.rendezvous, "sim-lossy") as robot, desk.running("top", "--robot", "sim-lossy") as process:
        robot.say(BATTERY, Battery(voltage=24.0), seqs, 20.0)
        assert process.stdout is not None
        lines = [process.stdout.readline() for _ in range(7)]
        process.send_signal(signal.SIGINT)
        assert process.wait(10.0) == 0
    assert any(line.rstrip().endswith("| base - | lost 3 | slow: none") for line in lines)
    assert lines[-1].rstrip().endswith("| base - | lost 3 | slow: battery - Hz")


def test_a_terminal_shows_it_and_is_given_back(desk: Desk, tmp_path: Path) -> None:
    environment = {**desk.environment, "TERM": "xterm-256color"}
    with screen([str(GIRAFF), "top"], tmp_path / "top.err", environment) as shown:
        shown.wait_for("odometry", 20.0)
        shown.wait_for("100.0", 20.0)
        shown.type(b"\x03")
        assert shown.process.wait(10.0) == 0
        assert shown.is_restored()
    assert (tmp_path / "top.err").read_text() == ""
