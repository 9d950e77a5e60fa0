"""`giraff run` by the clock: its pace, the rates of its topics, and how soon nothing of it is left."""

import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from giraff_schemas import topics
from tests.support.runs import SMALL_ROOM, Command, command_in
from tests.support.waiting import wait
from tests.timing.stalled import by_the_wall


@pytest.fixture
def command(tmp_path: Path) -> Iterator[Command]:
    with command_in(tmp_path) as made:
        yield made


def test_it_drives_around_the_room_and_sums_up(command: Command) -> None:
    begin_ns = time.monotonic_ns()
    code, out, err = command.run("--for", "20", "--truth", "exact", "--summary", "summary.json")
    assert (code, err) == (0, "")
    assert command.leaves_nothing()
    told = command.summary()
    assert told["odom_error_m"] < 0.01 * told["distance_m"]
    assert told["odom_error_deg"] < 1.0
    assert 0.0 < told["odom_sigma_m"] < 0.04 * told["distance_m"]
    assert told["truth"] == "exact"
    assert (told["contacts"], told["line_errors"]) == (0, 0)
    assert told["closest_m"] > 0.1
    assert (told["seed"], told["failures"]) == (1, [])
    assert f"distance  {told['distance_m']:.2f} m" in out
    with by_the_wall(begin_ns):
        require_its_pace(told)
        assert 20 <= sum(" | " in line for line in out.splitlines()) <= 27


def require_its_pace(told: dict[str, Any]) -> None:
    """Of 20 s in which nothing held it up."""
    assert told["distance_m"] > 4.0
    assert told["frames_lost"] == 0
    assert 20.0 <= told["duration_s"] < 25.0
    assert abs(told["skew_percent"]) < 2.0
    assert 0.0 < told["age_ms"]["p50"] <= told["age_ms"]["p99"] < 200.0
    for topic in (topics.TICK, topics.TILT, topics.CMD_VEL, topics.WHEELS, topics.ODOM):
        assert told["rates_hz"][topic.key] == pytest.approx(topic.rate_hz, rel=0.02)
    for sensor in ("front_left", "front_right", "rear"):
        assert told["rates_hz"][topics.RANGE.at(sensor).key] == pytest.approx(topics.RANGE.rate_hz, rel=0.05)


def test_a_script_drives_the_boards_that_were_compiled_for_this_machine(command: Command) -> None:
    script = command.directory / "script.csv"
    script.write_text("t,x,y,z\n0,0,0,9.81\n6,5,0,8.4\n8,0,0,9.81\n")
    world = command.directory / "world.toml"
    world.write_text(SMALL_ROOM)
    options = ["--boards", "host", "--seed", "7", "--tilt-script", str(script), "--summary", "summary.json"]
    options += ["--world", str(world)]
    code, _, err = command.run("--for", "9", *options)
    assert (code, err) == (0, "")
    told = command.summary()
    assert (told["boards"], told["seed"]) == ("host", 7)
    assert 0.5 < told["distance_m"] < 1.3  # two seconds at no more than 0.6 m/s
    assert command.leaves_nothing()


def test_being_killed_it_takes_everything_along_at_once(command: Command) -> None:
    with command.start() as process:
        command.wait_until_it_drives(process)
        process.kill()
    with by_the_wall():
        wait(lambda: not command.pids(), 3.0, what="the end of all children")


def test_told_to_end_while_it_drives_it_ends_soon(command: Command) -> None:
    with command.start() as process:
        command.wait_until_it_drives(process)
        begin_ns = time.monotonic_ns()
        process.terminate()
        _, err = process.communicate(timeout=60.0)
        took = (time.monotonic_ns() - begin_ns) * 1e-9
    assert (process.returncode, err) == (0, "")
    with by_the_wall(begin_ns):
        assert took <= 15.0
