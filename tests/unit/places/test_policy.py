"""Which changes giraff_places makes, and which it refuses."""

import math
from collections.abc import Callable

import pytest

from giraff_maps.places_file import KnownPlaces
from giraff_places.policy import Changed, PlacesPolicy, PlanFile
from giraff_schemas.localization import PlanarPose
from giraff_schemas.places import MOST, NoGoLine, Place, PlaceAdd, PlaceChange, PlaceForbid, PlaceRemove
from giraff_schemas.trouble import Trouble
from tests.support.robots import ROBOT
from tests.unit.places.homes import NOW, ROOM, policy_of, pose_of, walls_of

KITCHEN = Place(name="kitchen", x=1.0, y=1.0, yaw=0.0)
STAIRS = NoGoLine(name="line-1", x=0.0, y=1.0, end_x=1.0, end_y=1.0)
BATH = PlaceAdd(name="bath", pose=PlanarPose(x=1.0, y=1.0, yaw=0.0))


def made(policy: PlacesPolicy, change: PlaceChange, now: float = NOW) -> Changed:
    found = policy.changed(change, now)
    assert isinstance(found, Changed), found
    return found


def test_a_place_is_where_the_robot_is_or_where_it_was_said_to_be() -> None:
    policy = policy_of()
    here = made(policy, PlaceAdd(name="bath"))
    assert here == ("bath", KnownPlaces((Place(name="bath", x=1.0, y=2.0, yaw=math.radians(90.0)),)))
    policy.known = here.known
    far = PlanarPose(x=0.9999, y=3.00004, yaw=-7.0 * math.pi / 2.0)
    assert made(policy, PlaceAdd(name="attic", pose=far)).known.places[1] == Place(
        name="attic", x=1.0, y=3.0, yaw=math.radians(90.0)
    )


def test_lines_get_the_first_free_name_and_both_kinds_are_removed_by_theirs() -> None:
    policy = policy_of()
    policy.known = KnownPlaces((Place(name="line-2", x=1.0, y=1.0, yaw=0.0),), (STAIRS,))
    drawn = made(policy, PlaceForbid(x=-1.0, y=1.0004, end_x=9.0, end_y=1.0))
    assert drawn.name == "line-3"
    assert drawn.known.no_go[1] == NoGoLine(name="line-3", x=-1.0, y=1.0, end_x=9.0, end_y=1.0)
    assert made(policy, PlaceRemove(name="line-1")).known == KnownPlaces(policy.known.places)
    assert made(policy, PlaceRemove(name="line-2")).known == KnownPlaces((), (STAIRS,))


def full(policy: PlacesPolicy) -> None:
    places = tuple(Place(name=f"room {number}", x=1.0, y=1.0, yaw=0.0) for number in range(MOST))
    lines = tuple(NoGoLine(name=f"line-{number}", x=0.0, y=1.0, end_x=1.0, end_y=1.0) for number in range(MOST))
    policy.known = KnownPlaces(places, lines)


def of_another_plan(policy: PlacesPolicy) -> None:
    policy.on_map(walls_of(ROOM._replace(walls=ROOM.walls[:3])))


def with_a_broken_file(policy: PlacesPolicy) -> None:
    policy.file_fault = Trouble("home.places.toml: line 3: torn")


def well(policy: PlacesPolicy) -> None:
    del policy


@pytest.mark.parametrize(
    ("befallen", "change", "later", "why"),
    [
        (
            well,
            PlaceAdd(name="kitchen"),
            0.0,
            "kitchen is a place already, at (1, 1) m; run `giraff place remove kitchen`",
        ),
        (well, PlaceAdd(name="line-1"), 0.0, "line-1 is a no-go line already; run `giraff place remove line-1`"),
        (well, PlaceAdd(name="2nd"), 0.0, "'2nd' is no name: begin with a letter"),
        (
            well,
            PlaceAdd(name="bath", pose=PlanarPose(x=3.9, y=3.0, yaw=0.0)),
            0.0,
            "(3.9, 3) is about 0.09 m from a wall, and the robot needs 0.35 m",
        ),
        (well, PlaceAdd(name="bath"), 1.1, "no pose on the map is heard"),
        (lambda it: it.on_pose(pose_of(state="lost"), NOW), PlaceAdd(name="bath"), 0.0, "it is lost; drive it 2 m"),
        (lambda it: it.on_pose(pose_of("b"), NOW), BATH, 0.0, "two processes say where the robot is on the map"),
        (lambda it: it.on_pose(pose_of("b"), NOW + 2.0), BATH, 2.0, "localization is not heard"),
        (well, BATH, 3.1, "localization is not heard"),
        (
            of_another_plan,
            BATH,
            0.0,
            "localization goes by another floor plan, home, than home.toml; give both the same",
        ),
        (with_a_broken_file, BATH, 0.0, "home.places.toml: line 3: torn"),
        (full, BATH, 0.0, "200 are there already"),
        (full, PlaceForbid(x=0.0, y=1.0, end_x=1.0, end_y=1.0), 0.0, "200 are there already"),
        (
            well,
            PlaceForbid(x=5.0, y=0.0, end_x=5.0, end_y=1.0),
            0.0,
            "the line is off the map, which goes from (0.0, 0.0)",
        ),
        (well, PlaceRemove(name="kitchn"), 0.0, "no place and no line is called kitchn; did you mean kitchen?"),
        (well, PlaceRemove(name="xyz"), 0.0, "no place and no line is called xyz; there are kitchen, line-1"),
    ],
)
def test_a_change_is_refused(
    befallen: Callable[[PlacesPolicy], None], change: PlaceChange, later: float, why: str
) -> None:
    policy = policy_of()
    policy.known = KnownPlaces((KITCHEN,), (STAIRS,))
    befallen(policy)
    found = policy.changed(change, NOW + later)
    assert isinstance(found, Trouble)
    assert str(found).startswith(why)


def test_places_say_why_they_do_not_count() -> None:
    unheard = PlacesPolicy(PlanFile(ROOM, "home.toml"), ROBOT)
    told = unheard.places(NOW)
    assert (told.map, told.reason.what) == ("home", "localization is not heard")
    none = PlacesPolicy(Trouble("no map is given"), ROBOT)
    assert (none.places(NOW).map, str(none.places(NOW).reason)) == ("", "no map is given")
    assert not policy_of().places(NOW).reason
