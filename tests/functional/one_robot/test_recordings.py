"""A robot that drives is recorded, and what was recorded is said again."""

import os
import resource
import signal
from collections import defaultdict
from collections.abc import Mapping
from fnmatch import fnmatchcase
from pathlib import Path

import msgspec
import pytest
from mcap.reader import make_reader

from giraff_mcap.reading import Recording
from giraff_node.network.tokens import list_robots
from giraff_schemas.topics import PARAM_DESCRIBE, key_below, key_of
from tests.support.desk import Done, run_beside
from tests.support.elsewhere import clean, giraff
from tests.support.process_robot import FULL_TILT, PATIENCE, SAID, ProcessRobot
from tests.support.recorders import giraff_process, killed_recording, records
from tests.support.zygote import run_giraff

REPLAY = "replay-sim-test"


@pytest.fixture(scope="module", autouse=True)
def _circles(robot: ProcessRobot) -> None:
    """Drive in circles from now on."""
    robot.drive(FULL_TILT / 3.0, FULL_TILT, 0.5)


@pytest.fixture(scope="module")
def killed(robot: ProcessRobot) -> Path:
    """A recording whose process was killed at any moment."""
    return killed_recording(robot, "killed.mcap")[0]


def test_a_drive_is_recorded_to_the_last_sample(robot: ProcessRobot) -> None:
    path = robot.directory / "drive.mcap"
    with giraff_process(robot, "record", "-o", path.name, "--for", "4", "--json") as process:
        output, _ = process.communicate(timeout=60.0)
    assert process.returncode == 0
    report = msgspec.json.decode(output)
    sequences: dict[str, list[int]] = defaultdict(list)
    services: set[str] = set()
    with path.open("rb") as file:
        reader = make_reader(file, validate_crcs=True)
        assert reader.get_summary() is not None
        for schema, channel, message in reader.iter_messages():
            assert schema is not None
            content = msgspec.json.decode(message.data)
            if fnmatchcase(channel.topic, key_of("sim-test", PARAM_DESCRIBE)):
                services.add(content["service"])
                continue
            assert set(msgspec.json.decode(schema.data)["properties"]) == set(content)
            assert (content["seq"], content["stamp_ns"]) == (message.sequence, message.publish_time)
            sequences[channel.topic.removeprefix("giraff/sim-test/")].append(message.sequence)
    for key, numbers in sequences.items():
        assert numbers == sorted(set(numbers)), key
    # A busy machine drops samples, which are of no use when they are late; the recording says each one.
    missing = sum(numbers[-1] - numbers[0] + 1 - len(numbers) for numbers in sequences.values())
    assert {key: len(numbers) for key, numbers in sequences.items()} == {
        key: count["samples"] for key, count in report["keys"].items() if not fnmatchcase(key, PARAM_DESCRIBE.key)
    }
    assert (report["lost"], report["ended_by"]) == (missing, "--for 4")
    assert report["unread"] == {"gaps": [], "left_out": {}}
    assert set(sequences) >= SAID
    assert services >= {"base", "guard", "odometry", "ranger"}
    replayed = run_giraff(("replay", path.name, "--json"), path.parent, clean(dict(os.environ)), PATIENCE)
    [odom, *_] = msgspec.json.decode(replayed.stdout)
    assert odom["equal"] == odom["compared"], f"it needs no robot file: {odom} {replayed.stderr}"
    assert odom["compared"] > 100


def test_what_a_kill_left_is_repaired(robot: ProcessRobot, killed: Path) -> None:
    recording = Recording(killed)
    assert not recording.whole
    assert {count.lost for count in recording.counts.values()} == {0}
    done = giraff(robot, "record", "--repair", str(killed), "--json", name=None)
    assert done.returncode == 0, done.stderr
    repaired = Recording(killed.with_name("killed-repaired.mcap"))
    assert repaired.whole
    assert [(s.topic, s.heard_ns, s.payload) for s in repaired.samples()] == [
        (s.topic, s.heard_ns, s.payload) for s in recording.samples()
    ]
    assert "is there already" in giraff(robot, "record", "--repair", str(killed), name=None).stderr


def test_what_a_kill_left_is_said_again(robot: ProcessRobot, killed: Path) -> None:
    recorded = list(Recording(killed).samples())
    heard: list[tuple[str, bytes]] = []
    subscriber = robot.observer.door.declare_subscriber(
        key_below(REPLAY, "**"), lambda sample: heard.append((str(sample.key_expr), bytes(sample.payload)))
    )
    with giraff_process(robot, "play", killed.name, "--rate", "4") as process:
        output, complaint = process.communicate(timeout=60.0)
        robot.wait("the last sample", lambda: len(heard) == len(recorded), 60.0)
    del subscriber
    assert (process.returncode, complaint) == (0, "")
    assert f"as {REPLAY}: {len(recorded)} samples" in output
    assert heard == [(sample.topic.replace("sim-test", REPLAY), sample.payload) for sample in recorded]


def test_again_and_again_only_what_is_asked_for(robot: ProcessRobot, killed: Path) -> None:
    words = ("play", killed.name, "--rate", "100", "--topics", "odom", "--topics", "range/*", "--json")
    asked = {"odom", "range/front_left", "range/front_right", "range/rear"}
    heard: set[str] = set()
    subscriber = robot.observer.door.declare_subscriber(
        key_below(REPLAY, "**"), lambda sample: heard.add(str(sample.key_expr).split("/", 2)[2])
    )
    with giraff_process(robot, *words, "--loop") as process:
        robot.wait("a robot like others", lambda: REPLAY in list_robots(robot.observer.session), 60.0)
        robot.wait("all of it", lambda: asked <= heard, 60.0)
        process.send_signal(signal.SIGINT)
        output, _ = process.communicate(timeout=60.0)
    del subscriber
    assert heard == asked
    assert msgspec.json.decode(output)["samples"] > 0
    with giraff_process(robot, *words) as process:
        output, _ = process.communicate(timeout=60.0)
    assert msgspec.json.decode(output)["samples"] == len(list(Recording(killed).samples(("odom", "range/*"))))


def test_nothing_is_said_in_the_name_of_a_robot_that_is_there(robot: ProcessRobot, killed: Path) -> None:
    topics = ("cmd_vel/*", "range/*", "tilt")
    *refused, said = run_beside(
        lambda topic: giraff(robot, "play", str(killed), "--topics", topic, "--rate", "100"), topics
    ).values()
    for done in refused:
        assert done.returncode == 2
        assert "the robot is there (base, guard," in done.stderr, done.stderr
    assert said.returncode == 0, said.stderr


def little_room() -> None:
    resource.setrlimit(resource.RLIMIT_FSIZE, (150_000, 150_000))


@pytest.fixture(scope="module")
def filled(robot: ProcessRobot) -> Mapping[str, Done]:
    """By the names of their files: two recordings beside each other, until no more goes into each."""

    def until_full(name: str) -> Done:
        limit = ("--max-size", "200k") if name == "small.mcap" else ()
        preexec = little_room if name == "full.mcap" else None
        with giraff_process(robot, "record", "-o", name, *limit, preexec_fn=preexec) as process:
            output, complaint = process.communicate(timeout=60.0)
        return Done(name, process.returncode, output, complaint)

    return run_beside(until_full, ("small.mcap", "full.mcap"))


def test_a_limit_of_size_holds(robot: ProcessRobot, filled: Mapping[str, Done]) -> None:
    path = robot.directory / "small.mcap"
    assert filled[path.name].returncode == 0
    assert "ended by --max-size" in filled[path.name].stdout
    assert 100_000 < path.stat().st_size <= 200_000
    assert Recording(path).whole


def test_a_full_disk_ends_it_and_keeps_what_is_there(robot: ProcessRobot, filled: Mapping[str, Done]) -> None:
    path = robot.directory / "full.mcap"
    done = filled[path.name]
    assert done.returncode == 1
    kept = "full.mcap: cannot be written any more: File too large; what was recorded until then is kept"
    assert kept in done.stderr
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
        process.wait(60.0)
        assert process.stderr is not None
        assert "Traceback" not in process.stderr.read()
    assert Recording(path).ended_by == "Ctrl-C or a signal"
