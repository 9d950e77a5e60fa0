"""How soon what `giraff param` sets counts."""

import statistics
import time
from pathlib import Path

from giraff_node.network.query_client import QueryClient
from giraff_schemas.params import ParamSet
from giraff_schemas.topics import GUARD, PARAM_SET
from tests.support.process_robot import process_robot
from tests.timing.stalled import by_the_wall


def test_a_tightening_changes_the_verdict_within_a_fifth_of_a_second(tmp_path: Path) -> None:
    """What is taken back is free again once the sensors have said so anew: that takes longer, and is not timed."""
    with process_robot(tmp_path, boards="host") as robot:
        robot.arm()  # and so the sensors have proved that they hear
        robot.simulator.place(3.15, 0.0)  # 0.6 m before the wall
        heard: list[tuple[float, float]] = []
        robot.observer.listen(GUARD, lambda state: heard.append((time.monotonic(), state.forward.allowed)))

        def answered(margin: float) -> None:
            request = ParamSet(name="margin", value=margin, by="test")
            asking = QueryClient(robot.observer.session, "sim-test", PARAM_SET.at("guard"), request)
            robot.wait("an answer", lambda: asking.poll(time.monotonic()) is not None, 5.0)

        took, begin_ns = [], time.monotonic_ns()
        for _ in range(5):
            robot.wait("a free way", lambda: bool(heard) and heard[-1][1] > 0.4, 10.0)
            began = time.monotonic()
            answered(0.5)
            robot.wait("another verdict", lambda: heard[-1][1] < 0.2, 5.0)
            took.append(heard[-1][0] - began)
            answered(0.25)
    print("set to verdict:", [f"{seconds:.3f} s" for seconds in took])
    with by_the_wall(begin_ns):
        assert statistics.median(took) <= 0.2
