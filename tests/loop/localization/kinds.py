"""The kinds of drives that a localization is judged by."""

from collections.abc import Callable
from functools import cache
from typing import Final, NamedTuple

from giraff_localization.config import LocalizationConfig
from giraff_localization.floor import Floor
from giraff_localization.policy import LocalizationPolicy
from giraff_maps.read import read_map
from tests.loop.localization.drives import Variation, drive
from tests.loop.localization.floors import FILES, Differences
from tests.loop.localization.judging import Run, rows
from tests.support.robots import ROBOT

DEFAULTS: Final = LocalizationConfig()


class Kind(NamedTuple):
    """What is driven, and what the robot knows of it."""

    variation: Variation
    map: str = ""
    """The map it is looked for on; empty: the right one."""
    tracks: bool = False
    """It is told where it starts."""


_EXTRA: Final = Differences(sloppy=0.03, pieces=4)
_HARD: Final = Differences(sloppy=0.06, moved=0.25, pieces=4)
_EQUAL_ROOMS: Final = (0.0, 0.0, 3.4, 3.9), (3.5, 0.0, 6.9, 3.9)
_FLAT: Final = Variation("flat")
_ROOM: Final = Variation("living_room")

KINDS: Final = {
    "track": Kind(_FLAT, tracks=True),
    "track_room": Kind(_ROOM, tracks=True),
    "track_hard": Kind(_FLAT._replace(differences=_HARD), tracks=True),
    "global": Kind(_FLAT),
    "global_room": Kind(_ROOM),
    "hard": Kind(_FLAT._replace(differences=_HARD)),
    "furniture": Kind(_FLAT._replace(differences=_EXTRA)),
    "person": Kind(_FLAT._replace(person=True)),
    "deaf": Kind(_FLAT._replace(deaf=True)),
    "kidnapped": Kind(_FLAT._replace(kidnapped_after=20.0, metres=66.0)),
    "twin": Kind(Variation("twins", metres=15.0, parts=_EQUAL_ROOMS)),
    "twin_long": Kind(Variation("twins", metres=60.0, parts=_EQUAL_ROOMS)),
    "turned": Kind(Variation("turned", metres=60.0, differences=Differences())),
    "wrong": Kind(_FLAT._replace(metres=48.0), map="living_room"),
    "wrong_room": Kind(_ROOM._replace(metres=48.0), map="flat"),
}


@cache
def floor_of(world: str, config: LocalizationConfig) -> Floor:
    """What localization makes of a map: once, for all that look for a robot on it."""
    made = Floor(read_map(FILES[world]), config, ROBOT)
    for _ in made.build():
        pass
    return made


def policy(world: str, seed: int, config: LocalizationConfig = DEFAULTS) -> LocalizationPolicy:
    """One that looks for the robot anywhere on a map that is read already."""
    made = LocalizationPolicy(config, ROBOT, floor_of(world, config), seed)
    while made.work():
        pass
    return made


def run(kind: Kind, seed: int, config: LocalizationConfig = DEFAULTS, clock: Callable[[], float] | None = None) -> Run:
    """Drive, and look for the robot."""
    driven = drive(kind.variation, seed)
    looks = policy(kind.map or kind.variation.world, seed, config)
    return Run(seed, rows(driven, looks, tracks=kind.tracks, clock=clock), driven.kidnapped_at)
