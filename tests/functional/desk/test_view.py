"""`giraff view` as it is used: on a recording of the simulated robot, and beside the robot itself, without a screen."""

from __future__ import annotations

import contextlib
import math
import os
import shutil
import signal
import socket
import statistics
import subprocess
import time
import urllib.request
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import psutil
import pytest
from rerun.experimental import ViewerClient

from giraff_cli.watcher import free_port
from giraff_mcap.reading import Recording
from giraff_schemas.messages import Odometry
from giraff_viewer.colours import CONES, PATH, ROBOT
from tests.functional.desk.recorded import record_drive
from tests.functional.desk.seen import Floor
from tests.support.desk import run_beside
from tests.support.elsewhere import GIRAFF
from tests.support.process_robot import ProcessRobot, process_robot
from tests.support.waiting import wait
from tests.timing.stalled import by_the_wall

pytestmark = pytest.mark.usefixtures("able_to_draw")


@pytest.fixture(scope="module")
def driven(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[ProcessRobot, Path]]:
    """A robot that stands before a wall, and the recording of how it got there."""
    directory = tmp_path_factory.mktemp("driven")
    recording = directory / "drive.mcap"
    with process_robot(directory, boards="host") as robot:
        record_drive(robot, recording)
        yield robot, recording


def view(robot: ProcessRobot, *words: str, timeout: float = 90.0) -> subprocess.CompletedProcess[str]:
    """The command on the robot's host, without a screen."""
    return subprocess.run(
        [str(GIRAFF), "view", *words],
        cwd=robot.directory,
        env=screenless(robot),
        check=False,
        capture_output=True,
        text=True,
        timeout=timeout,
    )


def screenless(robot: ProcessRobot) -> dict[str, str]:
    return {name: value for name, value in robot.environment.items() if name not in ("DISPLAY", "WAYLAND_DISPLAY")}


@contextlib.contextmanager
def viewing(robot: ProcessRobot, *words: str) -> Iterator[subprocess.Popen[str]]:
    """The command, while it goes on; it and what it has started are ended with the block."""
    command = [str(GIRAFF), "view", *words]
    streams: dict[str, Any] = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    with subprocess.Popen(command, cwd=robot.directory, env=screenless(robot), **streams) as process:
        try:
            yield process
        finally:
            started = viewers_of(process) if process.poll() is None else []
            process.kill()
            for each in started:
                os.killpg(each.pid, signal.SIGKILL)


def viewers_of(process: subprocess.Popen[str]) -> list[psutil.Process]:
    """What a view has started; not what is about to be."""
    return [child for child in psutil.Process(process.pid).children(recursive=True) if child.name() == "rerun"]


def await_viewer(process: subprocess.Popen[str]) -> psutil.Process:
    wait(lambda: process.poll() is not None or viewers_of(process), 20.0, what="no viewer was started")
    assert process.poll() is None, process.communicate()
    return viewers_of(process)[0]


def test_a_recording_is_seen_with_robot_path_and_cones(driven: tuple[ProcessRobot, Path]) -> None:
    robot, recording = driven
    picture = robot.directory / "view.png"
    done = view(robot, str(recording), "--picture", str(picture), "--json")
    assert (done.returncode, done.stderr) == (0, "")
    counts = sum(count.samples for count in Recording(recording).counts.values())
    assert msgspec.json.decode(done.stdout) == {
        "robot": "sim-test",
        "samples": counts,
        "address": None,
        "file": str(picture),
    }
    if kept := os.environ.get("GIRAFF_PICTURES"):
        shutil.copy(picture, Path(kept) / "view.png")
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

    blocked = seen_from_robot(CONES["blocked"])
    near = seen_from_robot(CONES["near"])
    rear = seen_from_robot(CONES["doubted"])
    path = floor.points(PATH)
    assert blocked[0] > 0.4, "the front is blocked by the wall"
    assert near[0] > 0.4, "both look at it"
    assert abs(blocked[1] - near[1]) > 0.2, "one on the left, one on the right"
    assert rear[0] < -1.0
    assert abs(rear[1]) < 0.5, "the rear one looks straight back, as far as it can, and has heard nothing for long"
    assert floor.count(CONES["fault"]) == 0
    assert float(np.ptp(path, axis=0).max()) > 2.0 * size
    assert np.abs((path - middle) @ ahead).min() < 0.2 * size, "the path leads to the robot"
    assert ((path - middle) @ ahead < 0.3 * size).all(), "the robot came from behind"


def newest_yaw(recording: Path) -> float:
    *_, last = Recording(recording).samples(keys=("odom",))
    odometry = last.decode()
    assert isinstance(odometry, Odometry)
    return odometry.yaw


def test_a_recording_that_cannot_be_read_is_named(driven: tuple[ProcessRobot, Path]) -> None:
    robot, recording = driven
    nothing, cut = robot.directory / "nothing.mcap", robot.directory / "cut.mcap"
    nothing.write_bytes(b"")
    cut.write_bytes(recording.read_bytes()[:-3000])
    out, nowhere = robot.directory / "out.rrd", robot.directory / "no" / "such" / "folder.rrd"
    refused = {
        (str(robot.directory / "none.mcap"), "--save", str(out)): "No such file",
        (str(nothing), "--save", str(out)): "not an MCAP file",
        (str(recording), "--save", str(nowhere)): "No such file or directory",
        (str(recording),): "no screen here",
    }
    for words, done in run_beside(lambda words: view(robot, *words), refused).items():
        assert (done.returncode, done.stdout) == (2, ""), words
        assert refused[words] in done.stderr
    assert not out.exists()
    done = view(robot, str(cut), "--save", str(out))
    assert done.returncode == 0
    assert "cut off" in done.stderr


def test_what_cannot_be_is_refused(driven: tuple[ProcessRobot, Path]) -> None:
    robot, recording = driven
    refused = {
        ("--memory", "lots"): "'lots' is no amount of memory; give one like 500MB, 2GiB or 25%",
        ("--memory", "0"): "'0' is no amount of memory",
        ("--memory", "1MB"): "give 50MB at the least",
        ("--for", "-1"): "--for -1: give a positive number",
        ("--picture", "a.png"): "say when, with --for",
        ("--save", "a.rrd", "--web"): "one at a time",
        ("--robot", "otto", "--save", "otto.rrd", "--for", "1"): "no robot called otto is heard",
        (str(recording), "--robot", "otto"): "--robot and --connect are for a live robot",
        (str(recording), "--picture", "a.gif"): "give a name that ends in .png",
        (str(recording), "--picture", "no/such/a.png"): "there is no such folder",
    }
    for words, done in run_beside(lambda words: view(robot, *words), refused).items():
        assert (done.returncode, done.stdout) == (2, ""), words
        assert refused[words] in done.stderr


def test_a_live_robot_is_saved(driven: tuple[ProcessRobot, Path]) -> None:
    robot, _ = driven
    saved = robot.directory / "live.rrd"
    done = view(robot, "--save", str(saved), "--for", "2", "--json")
    assert (done.returncode, done.stderr) == (0, "")
    assert msgspec.json.decode(done.stdout)["samples"] > 200
    rerun = GIRAFF.with_name("rerun")
    told = subprocess.run([rerun, "rrd", "print", str(saved)], check=True, capture_output=True, text=True).stdout
    for entity in ("/floor/robot", "/frames/base_link", "/floor/range_rear_link", "/guard", "/log", "/hand/tilt"):
        assert entity in told
    assert subprocess.run([rerun, "rrd", "verify", str(saved)], check=False, capture_output=True).returncode == 0


def test_what_is_heard_is_in_the_viewer_at_once(driven: tuple[ProcessRobot, Path]) -> None:
    robot, _ = driven
    begin_ns = time.monotonic_ns()
    with viewing(robot, "--picture", "live.png", "--for", "20") as process:
        command = await_viewer(process).cmdline()
        client = connect(command[command.index("--port") + 1])
        late, until = [], time.monotonic() + 4.0
        while time.monotonic() < until:
            time.sleep(0.1)
            late.append(lateness(client))
        assert process.wait(60.0) == 0, process.communicate()
    print(f"from sample to the viewer's data: median {statistics.median(late):.3f} s, longest {max(late):.3f} s")
    with by_the_wall(begin_ns):
        assert statistics.median(late) <= 0.2
    assert Floor(robot.directory / "live.png").count(ROBOT) > 100


def connect(port: str) -> ViewerClient:
    """To a viewer, as soon as it has something of a robot."""
    clients: list[ViewerClient] = []

    def holds_something() -> bool:
        with contextlib.suppress(ConnectionError, TimeoutError):
            clients.append(ViewerClient(url=f"rerun+http://127.0.0.1:{port}/proxy"))
            return bool(clients[-1].get_state().recordings)
        return False

    wait(holds_something, 20.0, what="the viewer has nothing", every=0.1)
    return clients[-1]


def lateness(client: ViewerClient) -> float:
    """s since the newest that the viewer holds was heard; without an end where it is too busy to tell."""
    try:
        state = client.get_state()
    except TimeoutError:
        return math.inf
    timelines = (timeline for each in state.recordings for timeline in each.timelines)
    newest = max(timeline.end or 0 for timeline in timelines if timeline.name == "time")
    return time.time() - newest * 1e-9


def test_browsers_are_served(driven: tuple[ProcessRobot, Path]) -> None:
    robot, _ = driven
    port = free_port()
    with viewing(robot, "--web", "--port", str(port), "--memory", "100MB") as process:
        assert process.stderr is not None
        line = process.stderr.readline()
        assert f":{port}/?url=rerun%2Bhttp://" in line
        with urllib.request.urlopen(f"http://127.0.0.1:{port}/", timeout=10.0) as page:
            assert b"rerun" in page.read().lower()
        socket.create_connection(("127.0.0.1", port + 1), timeout=5.0).close()
        second = view(robot, "--web", "--port", str(port), "--for", "5")
        assert (second.returncode, "Address already in use; name another with --port" in second.stderr) == (2, True)
        process.send_signal(signal.SIGINT)
        assert process.wait(10.0) == 0


def test_no_viewer_is_left_behind_and_a_dead_one_is_told(driven: tuple[ProcessRobot, Path]) -> None:
    robot, _ = driven
    with viewing(robot, "--picture", "never.png", "--for", "100") as process:
        viewer = await_viewer(process)
        time.sleep(1.0)
        process.send_signal(signal.SIGTERM)
        assert process.wait(10.0) == 0
        assert not viewer.is_running()
    with viewing(robot, "--picture", "never.png", "--for", "100") as process:
        await_viewer(process).kill()
        assert process.wait(10.0) == 1
        assert process.stderr is not None
        assert "the viewer ended with -9" in process.stderr.read()
