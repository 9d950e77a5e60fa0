"""Pages are told of a floor plan while it grows, in simulated time."""

from giraff_core.timer import Timer
from giraff_schemas.localization import MapWalls
from giraff_schemas.topics import MAP
from giraff_sim.hosts.process import Process
from tests.loop.browsers import room


class Planner:
    """Says a plan twice a second, which grows after a second."""

    link = None

    def __init__(self, process: Process) -> None:
        self._maps, self._said = process.publisher(MAP), 0
        self.timers = (Timer(2.0),)

    def turn(self, now: float) -> None:
        if self.timers[0].due(now):
            self._said += 1
            walls = ((0.0, 0.0, 1.0, 0.0), (1.0, 0.0, 1.0, 2.0))
            self._maps.put(MapWalls(map="home", walls=walls[: 1 + (self._said > 2)]))

    def end(self) -> None:
        """Nothing is left to say."""


def test_a_plan_that_grows_is_told_when_it_changes_and_to_pages_that_come_later() -> None:
    with room() as it:
        phone = it.browsers.add("phone")
        it.loop.launch("planner", Planner, it.loop.hosts["operator"])
        it.run(3.0)
        later = it.browsers.add("laptop", may_drive=False)
        it.run(1.0)
        assert [len(plan.walls) for plan in phone.plans] == [1, 2]
        assert later.plans == phone.plans[-1:]
        assert (later.plans[0].map, later.plans[0].walls[1]) == ("home", ((1.0, 0.0), (1.0, 2.0)))
