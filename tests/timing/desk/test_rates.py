"""What `giraff top` and `giraff topic` measure beside a running robot, and how long that takes them."""

import json
import time

import psutil
import pytest

from tests.support.desk import Desk
from tests.support.process_robot import SERVICES, ProcessRobot
from tests.timing.stalled import by_the_wall


def test_top_weighs_what_services_really_take(robot: ProcessRobot, desk: Desk) -> None:
    before = {service: sum(psutil.Process(robot.pid(service)).cpu_times()[:2]) for service in SERVICES}
    began, begin_ns = time.monotonic(), time.monotonic_ns()
    report = desk.json("top", "--once")
    took = time.monotonic() - began
    topics = {stream["key"]: stream for stream in report["topics"]}
    with by_the_wall(begin_ns):
        for work in report["services"]:
            process = psutil.Process(robot.pid(work["service"]))
            spent = (sum(process.cpu_times()[:2]) - before[work["service"]]) / took
            assert work["cpu"] == pytest.approx(spent, rel=0.6, abs=0.03)  # not quite of the same time
        assert topics["cmd_vel"]["hz"] == pytest.approx(50.0, rel=0.2)


def test_lines_of_top_come_once_a_second_and_end_in_time(desk: Desk) -> None:
    begin_ns = time.monotonic_ns()
    done = desk.run("top", "--for", "3.5", "--json")
    assert (done.returncode, done.stderr) == (0, "")
    told = [json.loads(line) for line in done.stdout.splitlines()]
    assert all(report["robot"] == "sim-test" for report in told)
    with by_the_wall(begin_ns):
        assert [int(report["elapsed"]) for report in told] == [0, 1, 2, 3]


def test_list_and_bw_tell_the_rates_of_the_table(desk: Desk) -> None:
    begin_ns = time.monotonic_ns()
    rows = {row["key"]: row for row in desk.json("topic", "list", "--for", "2")}
    [odom] = [width for width in desk.json("topic", "bw", "--for", "3") if width["key"] == "odom"]
    with by_the_wall(begin_ns):
        for key in ("tick", "cmd_vel", "wheels", "odom"):
            assert rows[key]["hz"] == pytest.approx(rows[key]["nominal_hz"], rel=0.2), key
        assert 0.3 < odom["bytes"] / odom["bytes_per_second"] < 3.3  # s at whatever pace; a busy machine meets it late


def test_hz_of_the_robot_loses_nothing(desk: Desk) -> None:
    begin_ns = time.monotonic_ns()
    done = desk.run("topic", "hz", "odom", "--for", "4", "--json")
    [rate] = json.loads(done.stdout)["rates"]
    with by_the_wall(begin_ns):  # who stands still for long is not waited for
        assert 0.4 < rate["sent"] / rate["hz"] < 4.4  # s at whatever pace; a busy machine meets it late
        assert rate["lost"] == 0
        assert 0.0 <= rate["age_median"] < 0.1


def test_pub_keeps_its_rate(desk: Desk) -> None:
    words = ("topic", "pub", "battery", '{"voltage": 23.5}', "--robot", "sim-mine")
    begin_ns = time.monotonic_ns()
    with desk.running(*words, "--rate", "20"):
        rates = desk.run("topic", "hz", "battery", "--robot", "sim-mine", "--for", "2", "--json")
    [rate] = json.loads(rates.stdout)["rates"]
    with by_the_wall(begin_ns):
        assert rate["hz"] == pytest.approx(20.0, rel=0.1)
