"""Pages ask for routes beside hands that drive, in simulated time."""

from giraff_core.timer import Timer
from giraff_schemas.motion import MotionAnswer, MotionHold
from giraff_schemas.places import PlacesGo
from giraff_schemas.topics import PLACES_CANCEL, PLACES_GO, PLACES_HOLD
from giraff_sim.hosts.process import Process
from tests.loop.browsers import Room, room


class Router:
    """Answers as giraff_places does, and goes nowhere."""

    link = None

    def __init__(self, process: Process, it: Room) -> None:
        self._it = it
        self._goes, self._cancels = process.requests(PLACES_GO), process.requests(PLACES_CANCEL)
        self._holds = process.inbox(PLACES_HOLD)
        self.timers = (Timer(50.0),)
        self.drivers: list[str] = []
        """Who had the lease when a route was asked for."""
        self.asked: list[PlacesGo] = []
        self.cancelled: list[int] = []
        self.holds: list[tuple[float, MotionHold]] = []

    def turn(self, now: float) -> None:
        self.timers[0].due(now)
        self.holds += ((now, hold) for hold in self._holds.pop_all())
        for go in self._goes.pop_all():
            self.drivers.append(self._it.driver)
            self.asked.append(go.request)
            go.answer(MotionAnswer(accepted=True))
        for cancel in self._cancels.pop_all():
            self.cancelled.append(cancel.request.id)
            cancel.answer(MotionAnswer(accepted=True))

    def end(self) -> None:
        """Nothing is left to say."""


def test_a_page_that_has_driven_lets_go_of_the_robot_for_its_route_and_a_touch_takes_it_back() -> None:
    with room() as it:
        routers: list[Router] = []

        def started(process: Process) -> Router:
            routers.append(Router(process, it))
            return routers[0]

        it.loop.launch("router", started, it.loop.hosts["robot"])
        phone = it.browsers.add("phone")
        it.drive(phone)
        phone.let_go()
        it.run(0.3)
        assert it.driver == "web"
        phone.go("kitchen")
        it.run(2.0)
        (router,) = routers
        assert router.drivers == [""], "routes take the lease from nobody"
        assert len(router.holds) > 15
        phone.touch()
        it.run(0.3)
        held = len(router.holds)
        it.run(0.3)
        assert (it.driver, router.cancelled, len(router.holds)) == ("web", [router.asked[0].id], held)
