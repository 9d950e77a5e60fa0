"""Pages are told of a floor plan while it grows, and of its places, in simulated time."""

from giraff_core.timer import Timer
from giraff_schemas.localization import MapWalls
from giraff_schemas.places import NoGoLine, Place, Places
from giraff_schemas.topics import MAP, PLACES
from giraff_schemas.trouble import Trouble
from giraff_sim.hosts.process import Process
from tests.loop.browsers import room

DESK = Place(name="desk", x=0.5, y=1.0, yaw=0.0)
STAIRS = NoGoLine(name="stairs", x=0.0, y=0.5, end_x=1.0, end_y=0.12345)


class Planner:
    """Says a plan twice a second, which grows after a second, then gets a place, then a line."""

    link = None

    def __init__(self, process: Process) -> None:
        self._maps, self._said = process.publisher(MAP), 0
        self._places = process.publisher(PLACES)
        self.timers = (Timer(2.0),)

    def turn(self, now: float) -> None:
        if self.timers[0].due(now):
            self._said += 1
            walls = ((0.0, 0.0, 1.0, 0.0), (1.0, 0.0, 1.0, 2.0))
            self._maps.put(MapWalls(map="home", walls=walls[: 1 + (self._said > 2)]))
            said, counts = self._said, self._said != 3
            reason, lines = Trouble("" if counts else "by another plan"), (STAIRS,) if said > 4 or not counts else ()
            self._places.put(Places(map="home" if said > 2 else "attic", places=(DESK,), no_go=lines, reason=reason))

    def end(self) -> None:
        """Nothing is left to say."""


def test_a_plan_that_grows_is_told_when_it_changes_and_to_pages_that_come_later() -> None:
    with room() as it:
        phone = it.browsers.add("phone")
        it.loop.launch("planner", Planner, it.loop.hosts["operator"])
        it.run(3.0)
        later = it.browsers.add("laptop", may_drive=False)
        it.run(1.0)
        assert [(len(plan.walls), len(plan.places), len(plan.no_go)) for plan in phone.plans] == [
            *((1, 0, 0), (2, 0, 0), (2, 1, 0), (2, 1, 1)),
        ]
        assert later.plans == phone.plans[-1:]
        assert (later.plans[0].places, later.plans[0].no_go) == ((DESK,), (((0.0, 0.5), (1.0, 0.123)),))
        assert (later.plans[0].map, later.plans[0].walls[1]) == ("home", ((1.0, 0.0), (1.0, 2.0)))
