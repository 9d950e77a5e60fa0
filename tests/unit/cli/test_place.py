"""`giraff place`: what is asked of giraff_places, and how its places are shown."""

from typing import Any

import pytest

from giraff_cli.place import client
from giraff_cli.place.client import ask, next_places, print_places
from giraff_schemas import places as pl
from giraff_schemas.localization import PlanarPose
from giraff_schemas.topics import PLACES, PLACES_SET
from giraff_schemas.trouble import Trouble
from tests.unit.cli.asked import AskedRobot
from tests.unit.cli.quiet_network import meet
from tests.unit.cli.typed import Giraff

THERE = PlanarPose(x=1.0, y=-2.0, yaw=0.0)
LINE = pl.PlaceForbid(x=0.0, y=0.0, end_x=1.0, end_y=0.0)
TOLD = pl.Places(
    map="flat",
    places=(pl.Place(name="kitchen", x=3.2, y=-1.5, yaw=1.5708),),
    no_go=(pl.NoGoLine(name="line-1", x=5.0, y=0.0, end_x=5.0, end_y=1.2),),
)


@pytest.fixture
def robot(monkeypatch: pytest.MonkeyPatch) -> AskedRobot:
    made = AskedRobot("sim-here")
    made.rule(monkeypatch, client)
    return made


@pytest.mark.parametrize(
    ("change", "answer", "code", "said"),
    [
        (pl.PlaceAdd(name="bath"), "bath", 0, "sim-here: bath is where the robot is"),
        (pl.PlaceAdd(name="bath", pose=THERE), "bath", 0, "sim-here: bath is at x 1.00 y -2.00 m, 0.0°"),
        (pl.PlaceRemove(name="bath"), "bath", 0, "sim-here: bath is removed"),
        (LINE, "line-2", 0, "sim-here: line-2 is a line that no route crosses"),
        (LINE, "", 1, "places of sim-here refuses: it is off the map; look"),
        (
            LINE,
            None,
            2,
            "NOT CONFIRMED after 3 s: nobody answered giraff/sim-here/places/set; check that giraff_places",
        ),
    ],
)
def test_a_change_is_asked_and_its_answer_told(
    change: pl.PlaceChange, answer: str | None, code: int, said: str, robot: AskedRobot
) -> None:
    asked: list[Any] = []

    def say(request: Any) -> pl.PlacesAnswer | None:
        asked.append(request)
        reason = Trouble() if answer else Trouble("it is off the map", "look")
        return None if answer is None else pl.PlacesAnswer(done=bool(answer), name=answer, reason=reason)

    robot.answer((PLACES_SET,), say)
    result = ask(robot.connection, change, 3.0)
    assert (result.code, result.done) == (code, None if answer is None else bool(answer))
    assert result.text.startswith(said)
    assert asked[0].change == change
    assert len({request.id for request in asked}) == 1


def test_what_is_heard_is_shown_and_why_it_does_not_count(
    robot: AskedRobot, capsys: pytest.CaptureFixture[str]
) -> None:
    robot.clock.after(1.0, lambda: robot.put(PLACES, TOLD, "p"))
    heard = next_places(robot.connection, 3.0)
    assert heard is not None
    print_places("sim-here", heard)
    print_places("sim-there", pl.Places(map="flat", places=(), no_go=()))
    print_places("sim-else", pl.Places(map="", places=(), no_go=(), reason=Trouble("no map is given", "set it")))
    assert [line.rstrip() for line in capsys.readouterr().out.splitlines()] == [
        "sim-here: floor plan flat",
        "kitchen  x 3.20 y -1.50 m, 90.0°",
        "line-1   no-go line from 5.00,0.00 to 5.00,1.20 m",
        "sim-there: floor plan flat",
        "no places yet; `giraff place add NAME` gives one to where the robot is",
        "sim-else: no floor plan",
        "they do not count now: no map is given; set it",
    ]


@pytest.mark.parametrize(
    ("words", "why"),
    [
        (("add", "2nd"), "'2nd' is no name: begin with a letter"),
        (("remove", "a/b"), "'a/b' has '/' in it"),
        (("add", "bath", "-1,2"), "'-1,2' is no pose"),
        (("add", "bath", "--robt", "anne"), "no option --robt"),
        (("forbid", "-1,2", "-1,x"), "'-1,x' is no point"),
        (("forbid", "-1,2", "-1,2"), "both ends of the line are one point"),
    ],
)
def test_what_cannot_be_meant_is_told_before_anybody_is_asked(
    words: tuple[str, ...], why: str, monkeypatch: pytest.MonkeyPatch, giraff: Giraff
) -> None:
    network = meet(monkeypatch)
    code, out, complaint = giraff("place", *words)
    assert (code, out) == (2, "")
    assert complaint.startswith(f"giraff: place {words[0]}: {why}")
    assert network.opened == 0
