"""`giraff view` as it is used: on a recording of the simulated robot, and beside the robot itself, without a screen."""

import math
import signal
import socket
import subprocess
import urllib.request
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pytest

from giraff_core.kinematics.pose import ELLIPSE_95, Pose
from giraff_mcap.raw_sample import RawSample
from giraff_mcap.reading import Recording
from giraff_mcap.writing import RecordingWriter
from giraff_schemas.codec import encode, encoding_of, stamped
from giraff_schemas.messages import Odometry, Sample, TruePose
from giraff_schemas.topics import ODOM, TRUE_POSE, Topic, key_of, topic_of
from giraff_tools.network.ports import free_port
from giraff_viewer.colours import ELLIPSE, EVIDENCE, PATH, ROBOT, TRUTH
from giraff_viewer.scene import stock
from tests.functional.desk.seen import Floor, has_popup
from tests.functional.desk.views import await_viewer, view, viewing
from tests.support.desk import Desk
from tests.support.elsewhere import GIRAFF
from tests.support.process_robot import ProcessRobot
from tests.unit.mcap.recordings import ABOUT
from tests.unit.replay.drive import begin_of_the_drive

pytestmark = pytest.mark.timeout(240)

NOWHERE = "127.0.0.1:1"
"""Nobody is on the network of who looks at a recording."""
TO_THE_WALL_NS = 10_000_000_000
"""Of the recorded drive: the robot backs, drives ahead until a wall stops it, and has not heard its rear for long."""


def raw(topic: Topic[Any], sample: Sample, at_ns: int) -> RawSample:
    return RawSample(at_ns, key_of("sim-test", topic), encode(sample), encoding_of(type(sample)))


@pytest.fixture(scope="module")
def recording(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A robot has come to stand before a wall, is not sure where, and is somewhere else."""
    folder = tmp_path_factory.mktemp("recording")
    drive, path = begin_of_the_drive(folder / "begin.mcap", TO_THE_WALL_NS), folder / "drive.mcap"
    newest = [sample for sample in drive if sample.key == "odom"][-1]
    odometry = newest.decode()
    assert isinstance(odometry, Odometry)
    true = Pose(-0.9, 0.4, 0.3).placed_in(Pose(odometry.x, odometry.y, odometry.yaw))
    unsure = msgspec.structs.replace(odometry, covariance=(0.09, 0.03, 0.0, 0.04, 0.0, 0.04))
    told = stamped(TruePose(x=true.x, y=true.y, yaw=true.yaw, tick=odometry.tick), 0, newest.stamp_ns, "run")
    said = [RawSample(each.heard_ns, each.topic, each.payload, each.encoding) for each in drive]
    said += [raw(ODOM, unsure, said[-1].at_ns + 50_000_000), raw(TRUE_POSE, told, said[-1].at_ns + 100_000_000)]
    with RecordingWriter(path, ABOUT) as writer:
        writer.add(said)
        writer.close("test")
    return path


def test_a_recording_is_seen_with_robot_path_and_evidence(recording: Path, tmp_path: Path) -> None:
    picture = tmp_path / "view.png"
    done = view(Desk(tmp_path, NOWHERE), str(recording), "--picture", str(picture), "--json")
    assert (done.returncode, done.stderr) == (0, "")
    counts = sum(count.samples for key, count in Recording(recording).counts.items() if topic_of(key) is not None)
    assert msgspec.json.decode(done.stdout) == {
        "robot": "sim-test",
        "samples": counts,
        "address": None,
        "file": str(picture),
    }
    assert not has_popup(picture)
    floor = Floor(picture)
    body = floor.points(ROBOT)
    middle = (body.min(axis=0) + body.max(axis=0)) / 2.0
    size = float(np.ptp(body, axis=0).max())
    assert np.ptp(body, axis=0).min() > 0.9 * size, "the outline is no disc"
    assert 30.0 < size < 300.0
    yaw = newest_yaw(recording)
    ahead, left = np.array([math.cos(yaw), math.sin(yaw)]), np.array([-math.sin(yaw), math.cos(yaw)])

    def seen_from_robot(colour: tuple[int, int, int]) -> tuple[float, float]:
        """How far ahead and to the left the middle of a colour is, in robot's diameters."""
        to_it = (floor.middle(colour) - middle) / size
        return float(to_it @ ahead), float(to_it @ left)

    blocked = seen_from_robot(EVIDENCE["blocked"])
    near = seen_from_robot(EVIDENCE["near"])
    rear = seen_from_robot(EVIDENCE["doubted"])
    truth = seen_from_robot(TRUTH)
    path = floor.points(PATH)
    diameter = 2.0 * stock("sim-test").footprint_radius
    assert truth == pytest.approx((-0.9 / diameter, 0.4 / diameter), abs=0.2), "behind it, on its left, with a label"
    ellipse = floor.points(ELLIPSE)
    assert np.abs((ellipse.min(axis=0) + ellipse.max(axis=0)) / 2.0 - middle).max() < 0.15 * size
    assert float(np.ptp(ellipse, axis=0)[0]) / size == pytest.approx(2.0 * ELLIPSE_95 * 0.3 / diameter, rel=0.15)
    assert blocked[0] > 0.4, "the front is blocked by the wall"
    assert near[0] > 0.4, "both look at it"
    assert abs(blocked[1] - near[1]) > 0.2, "one on the left, one on the right"
    assert rear[0] < -1.0
    assert abs(rear[1]) < 0.5, "the rear one looks straight back, as far as it can, and has heard nothing for long"
    assert floor.count(EVIDENCE["fault"]) == 0
    assert float(np.ptp(path, axis=0).max()) > 2.0 * size
    assert np.abs((path - middle) @ ahead).min() < 0.2 * size, "the path leads to the robot"
    assert ((path - middle) @ ahead < 0.3 * size).all(), "the robot came from behind"


def newest_yaw(recording: Path) -> float:
    *_, last = Recording(recording).samples(keys=("odom",))
    odometry = last.decode()
    assert isinstance(odometry, Odometry)
    return odometry.yaw


def test_a_recording_that_is_cut_off_is_shown_as_far_as_it_goes(recording: Path, tmp_path: Path) -> None:
    cut, out = tmp_path / "cut.mcap", tmp_path / "out.rrd"
    cut.write_bytes(recording.read_bytes()[:-3000])
    done = view(Desk(tmp_path, NOWHERE), str(cut), "--save", str(out))
    assert done.returncode == 0
    assert "cut off" in done.stderr


def test_a_live_robot_is_saved(robot: ProcessRobot) -> None:
    saved = robot.directory / "live.rrd"
    done = view(robot, "--save", str(saved), "--for", "2", "--json")
    assert (done.returncode, done.stderr) == (0, "")
    assert msgspec.json.decode(done.stdout)["samples"] > 0
    rerun = GIRAFF.with_name("rerun")
    told = subprocess.run([rerun, "rrd", "print", str(saved)], check=True, capture_output=True, text=True).stdout
    for entity in (
        "/floor/robot",
        "/floor/ellipse",
        "/floor/echoes",
        "/frames/base_link",
        "/floor/evidence/rear",
        "/guard",
        "/log",
        "/hand/tilt",
    ):
        assert entity in told
    assert subprocess.run([rerun, "rrd", "verify", str(saved)], check=False, capture_output=True).returncode == 0


def test_what_is_heard_is_in_the_viewer(robot: ProcessRobot) -> None:
    done = view(robot, "--picture", "live.png", "--for", "2")
    assert done.returncode == 0, done
    assert Floor(robot.directory / "live.png").count(ROBOT) > 100
    assert not has_popup(robot.directory / "live.png")


def test_browsers_are_served(robot: ProcessRobot) -> None:
    port = free_port()
    with viewing(robot, "--web", "--port", str(port), "--memory", "100MB") as process:
        assert process.stderr is not None
        line = process.stderr.readline()
        assert f":{port}/?url=rerun%2Bhttp://" in line
        with urllib.request.urlopen(f"http://127.0.0.1:{port}/", timeout=60.0) as page:
            assert b"rerun" in page.read().lower()
        socket.create_connection(("127.0.0.1", port + 1), timeout=60.0).close()
        second = view(robot, "--web", "--port", str(port), "--for", "5")
        assert (second.returncode, "Address already in use; name another with --port" in second.stderr) == (2, True)
        process.send_signal(signal.SIGINT)
        assert process.wait(60.0) == 0


def test_no_viewer_is_left_behind_and_a_dead_one_is_told(robot: ProcessRobot) -> None:
    with viewing(robot, "--picture", "never.png", "--for", "100") as process:
        viewer = await_viewer(process)
        process.send_signal(signal.SIGTERM)
        assert process.wait(60.0) == 0
        assert not viewer.is_running()
    with viewing(robot, "--picture", "never.png", "--for", "100") as process:
        await_viewer(process).kill()
        assert process.wait(60.0) == 1
        assert process.stderr is not None
        assert "the viewer ended with -9" in process.stderr.read()
