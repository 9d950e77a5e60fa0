"""How soon what a robot says is in the viewer."""

import contextlib
import math
import statistics
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from rerun.experimental import ViewerClient

from giraff_viewer.colours import ROBOT
from tests.functional.desk.seen import Floor
from tests.functional.desk.views import await_viewer, viewing
from tests.support.process_robot import ProcessRobot, process_robot
from tests.support.waiting import wait
from tests.timing.stalled import by_the_wall


@pytest.fixture
def robot(tmp_path: Path) -> Iterator[ProcessRobot]:
    with process_robot(tmp_path, boards="host") as started:
        yield started


def test_what_is_heard_is_in_the_viewer_at_once(robot: ProcessRobot) -> None:
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
