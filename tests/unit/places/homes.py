"""A home of one room, its localization, and a giraff_places of it."""

from collections import defaultdict
from collections.abc import Callable
from pathlib import Path
from typing import Final
from unittest.mock import MagicMock

from giraff_core.io import Inbox
from giraff_core.kinematics.pose import Pose
from giraff_maps.floor_plan import FloorPlan
from giraff_maps.places_file import PlacesStore
from giraff_places.config import PlacesConfig
from giraff_places.policy import PlacesPolicy, PlanFile
from giraff_places.service import Places
from giraff_schemas.codec import stamped
from giraff_schemas.localization import LocalizationState, MapPose, MapWalls
from giraff_schemas.places import PlaceChange, PlacesAnswer, PlacesSet
from giraff_schemas.topics import MAP, PLACES, PLACES_SET, POSE
from giraff_schemas.trouble import Trouble
from tests.support.map_poses import map_pose
from tests.support.robots import ROBOT

ROOM: Final = FloorPlan(
    "home", ((0.0, 0.0, 4.0, 0.0), (4.0, 0.0, 4.0, 4.0), (4.0, 4.0, 0.0, 4.0), (0.0, 4.0, 0.0, 0.0))
)
HERE: Final = Pose(1.0004, 2.0, 1.5708)
NOW: Final = 100.0


def pose_of(instance: str = "a", state: LocalizationState = "localized") -> MapPose:
    """Return the pose that localization tells."""
    return stamped(map_pose(Pose(0.0, 0.0, 0.0), HERE, None, state), 0, 0, instance)


def walls_of(plan: FloorPlan = ROOM, instance: str = "a") -> MapWalls:
    """Return the floor plan that it tells."""
    return stamped(MapWalls(map=plan.name, walls=plan.walls), 0, 0, instance)


def policy_of() -> PlacesPolicy:
    """Return one that hears localization."""
    policy = PlacesPolicy(PlanFile(ROOM, "home.toml"), ROBOT)
    policy.on_map(walls_of())
    policy.on_pose(pose_of(), NOW)
    return policy


class Home:
    """A giraff_places with a real file, and what it says."""

    def __init__(self, folder: Path, no_plan: Trouble | None = None) -> None:
        self.path = folder / "home.places.toml"
        self.write: Callable[[Path, bytes], object] = Path.write_bytes
        self.io = MagicMock()
        boxes = defaultdict[object, Inbox[object]](lambda: Inbox(20))
        self._told = defaultdict[object, MagicMock](MagicMock)
        self.io.inbox.side_effect = lambda topic, **_: boxes[topic]
        self.io.requests.side_effect = boxes.__getitem__
        self.io.publisher.side_effect = self._told.__getitem__
        self._requests, self._poses, self._maps = boxes[PLACES_SET], boxes[POSE], boxes[MAP]
        plan = folder / "home.toml"
        store = PlacesStore(plan, self._write) if no_plan is None else None
        self._service = Places(self.io, PlacesConfig(), ROBOT, no_plan or PlanFile(ROOM, str(plan)), store)
        self.others = boxes[PLACES]
        """Takes what another giraff_places tells."""
        self._now = NOW

    def turn(self, seconds: float = 1.0) -> None:
        """Let time pass, and localization speak."""
        self._now += seconds
        self._maps.accept(walls_of())
        self._poses.accept(pose_of())
        self._service.turn(self._now)

    def ask(self, change: PlaceChange, id_: int) -> PlacesAnswer:
        """Ask for a change."""
        asked = MagicMock(request=PlacesSet(by="me", id=id_, change=change))
        self._requests.accept(asked)
        self.turn(0.01)
        answer: PlacesAnswer = asked.answer.call_args.args[0]
        return answer

    def _write(self, path: Path, data: bytes) -> None:
        self.write(path, data)

    @property
    def said(self) -> list[str]:
        """Names of the places and lines that were told last."""
        told = self._told[PLACES].put.call_args.args[0]
        return [each.name for each in (*told.places, *told.no_go)]

    @property
    def faults(self) -> dict[str, str]:
        """Last faults of the service, by what has them."""
        calls = self.io.set_fault.call_args_list
        return {call.args[0]: str(call.args[1]) for call in calls[-2:] if call.args[1]}
