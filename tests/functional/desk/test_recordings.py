"""A robot that drives is recorded, and what was recorded is said again."""

from __future__ import annotations

import resource
import signal
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path

import msgspec
import psutil
import pytest
from mcap.reader import make_reader

from giraff_mcap.reading import Recording
from giraff_schemas.topics import TOPICS, key_below
from tests.support.elsewhere import giraff
from tests.support.process_robot import FULL_TILT, ProcessRobot, process_robot
from tests.support.recorders import giraff_process, killed_recording, records, share_of_a_core

MINUTE = 60.0


@pytest.fixture(scope="module")
def robot(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ProcessRobot]:
    with process_robot(tmp_path_factory.mktemp("robot"), boards="host") as running:
        running.drive(FULL_TILT / 3.0, FULL_TILT, 0.5)  # in circles from now on
        yield running


@pytest.fixture(scope="module")
def killed(robot: ProcessRobot) -> tuple[Path, int]:
    """A recording whose process was killed at any moment, and when, ns since 1970."""
    return killed_recording(robot, "killed.mcap")


def test_a_minute_of_a_drive_is_recorded_to_the_last_sample(robot: ProcessRobot) -> None:
    path = robot.directory / "minute.mcap"
    with giraff_process(robot, "record", "-o", path.name, "--for", f"{MINUTE:g}", "--json") as process:
        records(process, path)
        share = share_of_a_core(psutil.Process(process.pid), MINUTE - 10.0)
        output, _ = process.communicate(timeout=30.0)
    assert process.returncode == 0
    report = msgspec.json.decode(output)
    sequences: dict[str, list[int]] = defaultdict(list)
    with path.open("rb") as file:
        reader = make_reader(file, validate_crcs=True)
        summary = reader.get_summary()
        assert summary is not None
        assert len(summary.chunk_indexes) > MINUTE
        for schema, channel, message in reader.iter_messages():
            assert schema is not None
            content = msgspec.json.decode(message.data)
            assert set(msgspec.json.decode(schema.data)["properties"]) == set(content)
            assert (content["seq"], content["stamp_ns"]) == (message.sequence, message.publish_time)
            sequences[channel.topic.removeprefix("giraff/sim-test/")].append(message.sequence)
    for key, numbers in sequences.items():
        assert numbers == list(range(numbers[0], numbers[0] + len(numbers))), key
    assert {key: len(numbers) for key, numbers in sequences.items()} == {
        key: count["samples"] for key, count in report["keys"].items()
    }
    assert (report["lost"], report["ended_by"], report["unreadable"]) == (0, "--for 60", {})
    rates = {topic.key: topic.rate_hz for topic in TOPICS}
    for key in ("wheels", "odom", "cmd_vel", "tick"):
        assert len(sequences[key]) > MINUTE * rates[key] / 2.0, key  # a busy machine's simulator is slow
    assert set(sequences) >= {topic.key for topic in TOPICS if "*" not in topic.key}
    print(f"{share:.1%} of a core")
    assert share < 0.10


def test_a_kill_costs_less_than_a_second(robot: ProcessRobot, killed: tuple[Path, int]) -> None:
    path, at_ns = killed
    recording = Recording(path)
    assert not recording.whole
    assert at_ns - max(sample.heard_ns for sample in recording.samples()) < 1_000_000_000
    assert {count.lost for count in recording.counts.values()} == {0}
    done = giraff(robot, "record", "--repair", str(path), "--json", name=None)
    assert done.returncode == 0, done.stderr
    repaired = Recording(path.with_name("killed-repaired.mcap"))
    assert repaired.whole
    assert [(s.topic, s.heard_ns, s.data) for s in repaired.samples()] == [
        (s.topic, s.heard_ns, s.data) for s in recording.samples()
    ]
    assert "is there already" in giraff(robot, "record", "--repair", str(path), name=None).stderr


def test_what_a_kill_left_is_said_again(robot: ProcessRobot, killed: tuple[Path, int]) -> None:
    path, _ = killed
    recorded = list(Recording(path).samples())
    heard: list[tuple[str, bytes]] = []
    subscriber = robot.observer.session.declare_subscriber(
        key_below("replay-sim-test", "**"), lambda sample: heard.append((str(sample.key_expr), bytes(sample.payload)))
    )
    with giraff_process(robot, "play", path.name) as process:
        output, complaint = process.communicate(timeout=60.0)
        robot.wait("the last sample", lambda: len(heard) == len(recorded), 5.0)
    del subscriber
    assert (process.returncode, complaint) == (0, "")
    assert f"as replay-sim-test: {len(recorded)} samples" in output
    assert heard == [(sample.topic.replace("sim-test", "replay-sim-test"), sample.payload()) for sample in recorded]


def test_faster_and_only_what_is_asked_for(robot: ProcessRobot, killed: tuple[Path, int]) -> None:
    path, _ = killed
    words = ("play", path.name, "--rate", "10", "--topics", "odom", "--topics", "range/*", "--json")
    with giraff_process(robot, *words) as process:
        output, _ = process.communicate(timeout=30.0)
    played = msgspec.json.decode(output)
    recording = Recording(path)
    assert played["samples"] == len(list(recording.samples(("odom", "range/*"))))
    assert played["seconds"] == pytest.approx(recording.seconds / 10.0, abs=0.3)


def test_nothing_is_said_in_the_name_of_a_robot_that_is_there(robot: ProcessRobot, killed: tuple[Path, int]) -> None:
    path, _ = killed
    for topic in ("cmd_vel", "cmd_vel/*", "tick", "lease", "range/*"):
        done = giraff(robot, "play", str(path), "--topics", topic)
        assert done.returncode == 2
        assert "the robot is there (base, guard," in done.stderr, done.stderr
    assert giraff(robot, "play", str(path), "--topics", "tilt", "--rate", "100").returncode == 0


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (("record", "--topics", "odmo"), "--topics odmo: no such topic; there are tick, "),
        (("record", "-o", "/proc/none/a.mcap"), "cannot be written: No such file"),
        (("record", "--max-size", "7"), "give 100k at least"),
        (("play", "nothing.mcap"), "No such file"),
        (("play", "/etc/hostname"), "not an MCAP file"),
    ],
)
def test_what_cannot_be_is_told_in_a_line(robot: ProcessRobot, words: tuple[str, ...], says: str) -> None:
    name = "sim-test" if words[0] == "record" else None
    done = giraff(robot, *words, name=name)
    assert done.returncode == 2
    assert says in " ".join(done.stderr.replace("│", " ").split())
    assert "Traceback" not in done.stderr


def test_a_robot_that_is_not_there_is_waited_for(robot: ProcessRobot) -> None:
    done = giraff(robot, "record", "-o", str(robot.directory / "nobody.mcap"), "--for", "4", name="nobody")
    assert done.returncode == 2
    assert "no robot called nobody is heard" in done.stderr
    assert "on the network: --robot sim-test; waiting for it" in done.stderr
    assert not (robot.directory / "nobody.mcap").exists()


def test_of_two_robots_none_is_guessed(robot: ProcessRobot, killed: tuple[Path, int]) -> None:
    path, _ = killed
    with giraff_process(robot, "play", path.name, "--loop"):
        robot.wait(
            "the second", lambda: "replay-sim-test" in giraff(robot, "record", "--for", "1", name=None).stderr, 20.0
        )
        done = giraff(robot, "record", "--for", "5", name=None)
        assert done.returncode == 2
        assert "several robots are on the network; name one: --robot replay-sim-test, --robot sim-test" in done.stderr


def test_a_limit_of_size_holds(robot: ProcessRobot) -> None:
    path = robot.directory / "small.mcap"
    with giraff_process(robot, "record", "-o", path.name, "--max-size", "200k") as process:
        output, _ = process.communicate(timeout=30.0)
    assert process.returncode == 0
    assert "ended by --max-size" in output
    assert 100_000 < path.stat().st_size <= 200_000
    assert Recording(path).whole


def test_a_full_disk_ends_it_and_keeps_what_is_there(robot: ProcessRobot) -> None:
    path = robot.directory / "full.mcap"

    def little_room() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (150_000, 150_000))

    with giraff_process(robot, "record", "-o", path.name, preexec_fn=little_room) as process:
        _, complaint = process.communicate(timeout=30.0)
    assert process.returncode == 1
    assert "full.mcap: cannot be written any more: File too large; what was recorded until then is kept" in complaint
    recording = Recording(path)
    assert not recording.whole
    assert len(list(recording.samples())) > 500


def test_a_signal_and_a_reader_who_goes_end_it_well(robot: ProcessRobot) -> None:
    path = robot.directory / "stopped.mcap"
    with giraff_process(robot, "record", "-o", path.name) as process:
        records(process, path)
        assert process.stdout is not None
        process.stdout.close()
        process.send_signal(signal.SIGTERM)
        process.wait(10.0)
        assert process.stderr is not None
        assert "Traceback" not in process.stderr.read()
    assert Recording(path).ended_by == "Ctrl-C or a signal"
