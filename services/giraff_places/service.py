"""Places: `map`, `pose` and a file to `places`. It is no part of what keeps the robot from obstacles."""

from collections import deque
from typing import Final

from giraff_core.io import IO
from giraff_core.robot import RobotConfig
from giraff_core.timer import Timer
from giraff_maps.floor_plan import MapError
from giraff_maps.places_file import PlacesStore
from giraff_places.config import PlacesConfig
from giraff_places.policy import PlacesPolicy, PlanFile
from giraff_schemas.places import NO_ROUTE, PlacesAnswer, PlacesSet
from giraff_schemas.topics import MAP, PLACES, PLACES_SET, POSE, ROUTE
from giraff_schemas.trouble import NO_TROUBLE, Trouble

_REMEMBERED: Final = 64
"""Changes that are made once."""


class Places:
    """Reads `map`, `pose` and the file beside the floor plan; writes `places`, and that file."""

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
        # Each pose wakes it: how fresh one is, it knows by when it came.
        self._poses, self._maps = io.inbox(POSE, limit=10), io.inbox(MAP, limit=1, wakes=False)
        self._others = io.inbox(PLACES, limit=10, wakes=False)
        self._requests = io.requests(PLACES_SET)
        self._places = io.publisher(PLACES)
        self._routes = io.publisher(ROUTE)
        self._timer, self._route_timer = self.timers = Timer(PLACES.rate_hz), Timer(ROUTE.rate_hz)
        self._made: deque[tuple[int, PlacesAnswer]] = deque(maxlen=_REMEMBERED)

    def turn(self, now: float) -> None:
        policy = self._policy
        for walls in self._maps.pop_all():
            policy.on_map(walls)
        for pose in self._poses.pop_all():
            policy.on_pose(pose, now)
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
        if self._route_timer.due(now):
            self._routes.put(NO_ROUTE)
        self._io.set_fault("plan", policy.no_plan)
        self._io.set_fault("file", policy.file_fault)
        is_whole = not (policy.no_plan or policy.file_fault)
        self._io.set_notice("localization", policy.reason(now) if is_whole else NO_TROUBLE)

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


def _refused(reason: Trouble) -> PlacesAnswer:
    return PlacesAnswer(done=False, reason=reason)
