"""Places: `map`, `pose` and a file to `places`, and routes to motions. The guard keeps the robot from obstacles."""

import math
from collections import deque
from typing import Any, Final

from giraff_core.io import IO
from giraff_core.retry import RetriedRequest
from giraff_core.robot import RobotConfig
from giraff_core.timer import EarlyTimer, Timer
from giraff_maps.floor_plan import MapError
from giraff_maps.places_file import PlacesStore
from giraff_places.config import PlacesConfig
from giraff_places.driving.driving import Driving
from giraff_places.driving.robot import Motions
from giraff_places.policy import PlacesPolicy, PlanFile
from giraff_schemas.places import PlacesAnswer, PlacesSet
from giraff_schemas.topics import (
    ESTOP,
    LEASE,
    MAP,
    MOTION,
    MOTION_HOLD,
    PLACES,
    PLACES_CANCEL,
    PLACES_GO,
    PLACES_HOLD,
    PLACES_SET,
    POSE,
    RANGE,
    ROUTE,
    SCAN,
    TICK,
    Query,
)
from giraff_schemas.trouble import NO_TROUBLE, Trouble

_REMEMBERED: Final = 64
"""Changes that are made once."""
_LATE: Final = 50
"""Holds between two turns of which none is left out."""
_TURNS: Final = 50.0
"""Hz; of a route."""


class Places:
    """Reads `map`, `pose` and the file beside the floor plan; writes `places`, and that file. Drives one route."""

    link = None

    def __init__(
        self,
        io: IO,
        config: PlacesConfig,
        robot: RobotConfig,
        source: PlanFile | Trouble,
        store: PlacesStore | None,
    ) -> None:
        """`source`: as of its policy. `store`: the file of the places. None: there is no plan. Raises MapError."""
        del config
        self._io, self._store = io, store
        self._policy = PlacesPolicy(source, robot)
        self._motion_holds = io.publisher(MOTION_HOLD)
        motions = Motions(self._ask, self._motion_holds.put, io.token, io.instance)
        self._driving = Driving(self._policy, robot, motions)
        # Each pose wakes it: how fresh one is, it knows by when it came. A hold wakes it, since it is passed on.
        self._poses, self._maps = io.inbox(POSE, limit=10), io.inbox(MAP, limit=1, wakes=False)
        self._others = io.inbox(PLACES, limit=10, wakes=False)
        self._holds = io.inbox(PLACES_HOLD, limit=_LATE)
        self._ticks, self._leases = io.inbox(TICK, limit=1, wakes=False), io.inbox(LEASE, limit=10, wakes=False)
        self._estops, self._motions = io.inbox(ESTOP, limit=10, wakes=False), io.inbox(MOTION, limit=20, wakes=False)
        self._senses = (io.inbox(RANGE, limit=20, wakes=False), io.inbox(SCAN, limit=2, wakes=False))
        self._requests, self._gos = io.requests(PLACES_SET), io.requests(PLACES_GO)
        self._cancels = io.requests(PLACES_CANCEL)
        self._places = io.publisher(PLACES)
        self._routes = io.publisher(ROUTE)
        self._timer, self._route_timer, self._pace = Timer(PLACES.rate_hz), EarlyTimer(ROUTE.rate_hz), _Pace(_TURNS)
        self.timers = (self._timer, self._route_timer, self._pace)
        self._told: tuple[object, ...] = ()
        self._made: deque[tuple[int, PlacesAnswer]] = deque(maxlen=_REMEMBERED)

    def turn(self, now: float) -> None:
        policy = self._policy
        for walls in self._maps.pop_all():
            policy.on_map(walls)
        for pose in self._poses.pop_all():
            policy.on_pose(pose, now)
            self._driving.on_pose(pose, now)
        if any(places.instance != self._io.instance for places in self._others.pop_all()):
            policy.on_other(now)
        known = policy.known
        is_due = self._timer.due(now)
        if is_due:
            self._read()  # somebody may have edited it by hand
        for asked in self._requests.pop_all():
            asked.answer(self._on_set(asked.request, now))
        if is_due or policy.known != known:
            self._places.put(policy.places(now))
        self._drive(now)
        self._io.set_fault("plan", policy.no_plan)
        self._io.set_fault("file", policy.file_fault)
        is_whole = not (policy.no_plan or policy.file_fault)
        self._io.set_notice("localization", policy.reason(now) if is_whole else NO_TROUBLE)

    def _drive(self, now: float) -> None:
        """Have the route go on, and tell of it."""
        driving = self._driving
        self._read_inboxes(now)
        for go in self._gos.pop_all():
            go.answer(driving.on_request(go.request, now))
        for cancel in self._cancels.pop_all():
            cancel.answer(driving.on_cancel(cancel.request, now))
        self._pace.due(now)
        driving.turn(now)
        self._pace.runs = driving.is_active
        state = driving.state(now)
        news = state.id, state.stage, state.outcome, state.reason, state.corners
        if news != self._told:
            self._told = news
            self._route_timer.fire_now("news", now)
        if self._route_timer.due(now):
            self._routes.put(state)

    def _read_inboxes(self, now: float) -> None:
        driving = self._driving
        for tick in self._ticks.pop_all():
            driving.on_tick(tick, now)
        for lease in self._leases.pop_all():
            driving.on_lease(lease, now)
        for estop in self._estops.pop_all():
            driving.on_estop(estop, now)
        for state in self._motions.pop_all():
            driving.on_state(state, now)
        for sense in self._senses:
            for sample in sense.pop_all():
                driving.on_sample(sample, now)
        for hold in self._holds.pop_all():
            driving.on_hold(hold, now)

    def _ask(self, query: Query[Any, Any], request: Any) -> RetriedRequest[Any]:
        return self._io.ask(query, request, lambda _: True)

    def end(self) -> None:
        """Nothing is left to say."""

    def _read(self) -> None:
        """Read the file. One that cannot be read leaves the places that were known, which then do not count."""
        if self._store is None:
            return
        try:
            self._policy.known, self._policy.file_fault = self._store.read(), NO_TROUBLE
        except MapError as error:
            self._policy.file_fault = Trouble(str(error))

    def _on_set(self, request: PlacesSet, now: float) -> PlacesAnswer:
        if made := next((answer for id_, answer in self._made if id_ == request.id), None):
            return made
        if self._store is None:
            return _refused(self._policy.no_plan)
        self._read()
        changed = self._policy.changed(request.change, now)
        if isinstance(changed, Trouble):
            return _refused(changed)
        try:
            self._store.write(changed.known)
        except MapError as error:
            return _refused(Trouble(str(error)))
        self._policy.known = changed.known
        answer = PlacesAnswer(done=True, name=changed.name)
        self._made.append((request.id, answer))
        return answer


class _Pace(Timer):
    """Turns while a route goes on, and none else."""

    runs = False

    def wait(self, now: float) -> float:
        return super().wait(now) if self.runs else math.inf


def _refused(reason: Trouble) -> PlacesAnswer:
    return PlacesAnswer(done=False, reason=reason)
