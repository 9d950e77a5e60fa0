"""`giraff place`: what is asked of giraff_places, and how its places are shown."""

import json
from typing import Any

import pytest

from giraff_cli.place import client
from giraff_cli.place.client import ask, document, next_places, print_places
from giraff_schemas.localization import PlanarPose
from giraff_schemas.places import (
    NoGoLine,
    Place,
    PlaceAdd,
    PlaceChange,
    PlaceForbid,
    PlaceRemove,
    Places,
    PlacesAnswer,
)
from giraff_schemas.topics import PLACES, PLACES_SET
from giraff_schemas.trouble import Trouble
from tests.unit.cli.asked import AskedRobot
from tests.unit.cli.quiet_network import meet
from tests.unit.cli.typed import Giraff

NAME = "sim-here"
TOLD = Places(
    map="flat",
    places=(Place(name="kitchen", x=3.2, y=-1.5, yaw=1.5708),),
    no_go=(NoGoLine(name="line-1", x=5.0, y=0.0, end_x=5.0, end_y=1.2),),
)


@pytest.fixture
def robot(monkeypatch: pytest.MonkeyPatch) -> AskedRobot:
    made = AskedRobot(NAME)
    made.rule(monkeypatch, client)
    return made


@pytest.mark.parametrize(
    ("change", "answer", "code", "said"),
    [
        (PlaceAdd(name="bath"), PlacesAnswer(done=True, name="bath"), 0, "sim-here: bath is where the robot is"),
        (
            PlaceAdd(name="bath", pose=PlanarPose(x=1.0, y=-2.0, yaw=0.0)),
            PlacesAnswer(done=True, name="bath"),
            0,
            "sim-here: bath is at x 1.00 y -2.00 m, 0.0°",
        ),
        (PlaceRemove(name="bath"), PlacesAnswer(done=True, name="bath"), 0, "sim-here: bath is removed"),
        (
            PlaceForbid(x=0.0, y=0.0, end_x=1.0, end_y=0.0),
            PlacesAnswer(done=True, name="line-2"),
            0,
            "sim-here: line-2 is a line that no route crosses",
        ),
        (
            PlaceRemove(name="bath"),
            PlacesAnswer(done=False, reason=Trouble("no such place", "look")),
            1,
            "places of sim-here refuses: no such place; look",
        ),
        (
            PlaceRemove(name="bath"),
            None,
            2,
            "NOT CONFIRMED after 3 s: nobody answered giraff/sim-here/places/set; check",
        ),
    ],
)
def test_a_change_is_asked_and_its_answer_told(
    change: PlaceChange, answer: PlacesAnswer | None, code: int, said: str, robot: AskedRobot
) -> None:
    asked: list[Any] = []

    def say(request: Any) -> PlacesAnswer | None:
        asked.append(request)
        return answer

    robot.answer((PLACES_SET,), say)
    result = ask(robot.connection, change, 3.0)
    assert result.code == code
    assert result.text.startswith(said)
    assert result.done == (None if answer is None else answer.done)
    assert asked[0].change == change
    assert len({request.id for request in asked}) == 1


def test_what_is_heard_is_shown(robot: AskedRobot, capsys: pytest.CaptureFixture[str]) -> None:
    robot.clock.after(1.0, lambda: robot.put(PLACES, TOLD, "p"))
    heard = next_places(robot.connection, 3.0)
    assert heard is not None
    print_places(NAME, heard)
    assert [line.rstrip() for line in capsys.readouterr().out.splitlines()] == [
        "sim-here: floor plan flat",
        "kitchen  x 3.20 y -1.50 m, 90.0°",
        "line-1   no-go line from 5.00,0.00 to 5.00,1.20 m",
    ]
    assert json.loads(json.dumps(document(NAME, heard)))["places"][0]["name"] == "kitchen"


def test_why_they_do_not_count_is_shown_and_so_is_that_there_are_none(capsys: pytest.CaptureFixture[str]) -> None:
    print_places(NAME, Places(map="", places=(), no_go=(), reason=Trouble("no map is given", "set it")))
    print_places(NAME, Places(map="flat", places=(), no_go=()))
    assert capsys.readouterr().out == (
        "sim-here: no floor plan\nthey do not count now: no map is given; set it\n"
        "sim-here: floor plan flat\nno places yet; `giraff place add NAME` gives one to where the robot is\n"
    )


@pytest.mark.parametrize(
    ("words", "why"),
    [
        (("add", "2nd"), "place add: '2nd' is no name: begin with a letter"),
        (("remove", "a/b"), "place remove: 'a/b' has '/' in it"),
        (("add", "bath", "-1,2"), "place add: '-1,2' is no pose"),
        (("add", "bath", "--robt", "anne"), "place add: no option --robt"),
        (("forbid", "-1,2", "-1,x"), "place forbid: '-1,x' is no point"),
        (("forbid", "-1,2", "-1,2"), "place forbid: both ends of the line are one point"),
    ],
)
def test_what_cannot_be_meant_is_told_before_anybody_is_asked(
    words: tuple[str, ...], why: str, monkeypatch: pytest.MonkeyPatch, giraff: Giraff
) -> None:
    network = meet(monkeypatch)
    code, out, complaint = giraff("place", *words)
    assert (code, out) == (2, "")
    assert complaint.startswith(f"giraff: {why}")
    assert network.opened == 0
