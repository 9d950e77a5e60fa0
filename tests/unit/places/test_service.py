"""giraff_places with its file: what stays in it, what is refused, and what is done once."""

import errno
import os
from pathlib import Path

import pytest

from giraff_node.process.state import write_file_durably
from giraff_schemas.codec import stamped
from giraff_schemas.localization import PlanarPose
from giraff_schemas.places import PlaceAdd, PlaceChange, PlaceForbid, PlaceRemove, Places
from giraff_schemas.trouble import Trouble
from tests.unit.places.homes import Home

BATH = PlaceAdd(name="bath", pose=PlanarPose(x=1.0, y=1.0, yaw=0.1))
EDITED = """# mine

[places.kitchen]          # the warm one
x = 1
y = 2.5
yaw_deg = 90.0

# the stairs
[no_go.stairs]
points = [
    [0.0, 1.0],
    [1.0, 1.0],
]
"""
"""A file as a person writes it."""


def test_a_new_file_says_what_it_is_and_a_change_is_told_at_once(tmp_path: Path) -> None:
    home = Home(tmp_path)
    home.turn()
    assert not home.path.exists()
    assert home.ask(BATH, 1).done
    assert home.said == ["bath"]
    answer = home.ask(PlaceForbid(x=0.0, y=1.0, end_x=1.0, end_y=1.25), 2)
    assert (answer.done, answer.name) == (True, "line-1")
    assert home.ask(PlaceAdd(name="Café 2"), 3).done
    assert home.said == ["bath", "Café 2", "line-1"]
    assert home.path.read_text() == (
        "# Places and no-go lines of the floor plan home. `giraff place` writes them, and people may, too.\n"
        "\n[places.bath]\nx = 1.0\ny = 1.0\nyaw_deg = 5.7\n"
        "\n[no_go.line-1]\npoints = [[0.0, 1.0], [1.0, 1.25]]\n"
        '\n[places."Café 2"]\nx = 1.0\ny = 2.0\nyaw_deg = 90.0\n'
    )


def test_the_same_wish_is_met_once_and_answered_alike(tmp_path: Path) -> None:
    home = Home(tmp_path)
    first = home.ask(BATH, 7)
    assert home.ask(PlaceRemove(name="bath"), 8).done
    assert home.ask(BATH, 7) == first
    assert home.said == []


def test_what_a_person_has_written_stays_and_counts(tmp_path: Path) -> None:
    home = Home(tmp_path)
    assert home.ask(BATH, 1).done
    home.path.write_text(EDITED)
    assert home.ask(PlaceRemove(name="kitchen"), 2).done
    assert home.said == ["stairs"]
    kept = EDITED[EDITED.index("# the stairs") :]
    assert home.path.read_text() == f"# mine\n\n{kept}"
    home.path.write_text(EDITED)
    assert home.ask(PlaceRemove(name="stairs"), 3).done
    assert home.path.read_text() == EDITED.partition("[no_go")[0]
    home.path.write_text(EDITED)
    home.turn()
    assert home.said == ["kitchen", "stairs"], "without being asked"


def test_a_form_that_cannot_be_changed_is_left_alone(tmp_path: Path) -> None:
    home = Home(tmp_path)
    text = "places = { kitchen = { x = 1.0, y = 1.0, yaw_deg = 0.0 } }\n"
    home.path.write_text(text)
    for number, change in enumerate[PlaceChange]((BATH, PlaceRemove(name="kitchen"))):
        answer = home.ask(change, number)
        assert "give each place and line a table of its own" in str(answer.reason)
        assert home.path.read_text() == text


def test_a_file_that_cannot_be_read_is_a_fault_and_is_not_overwritten(tmp_path: Path) -> None:
    home = Home(tmp_path)
    home.path.write_text("[places.kitchen]\nx = 1.0\ny = 2.0\nyaw = 3.0\n")
    home.turn()
    why = f"{home.path}: [places.kitchen]: unknown field `yaw`; mend it, or remove it"
    assert home.faults == {"file": why}
    before = home.path.read_bytes()
    assert str(home.ask(BATH, 1).reason) == why
    assert home.path.read_bytes() == before
    home.path.write_text(EDITED)
    home.turn()
    assert (home.faults, home.said) == ({}, ["kitchen", "stairs"])


def test_a_full_disk_refuses_and_changes_nothing(tmp_path: Path) -> None:
    def fail(path: Path, _data: bytes) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(path))

    home = Home(tmp_path)
    home.turn()
    home.write = fail
    told = str(home.ask(BATH, 1).reason)
    assert told.startswith(f"{home.path} cannot be written: No space left on device; make room on that disk")
    home.turn()
    assert home.said == []
    home.write = Path.write_bytes
    assert home.ask(BATH, 1).done


def test_without_a_plan_it_says_so_and_refuses(tmp_path: Path) -> None:
    home = Home(tmp_path, Trouble("no map is given", "set it"))
    assert str(home.ask(BATH, 1).reason) == "no map is given; set it"
    assert home.faults == {"plan": "no map is given; set it"}
    assert not [*tmp_path.iterdir()]


def test_two_of_them_change_nothing(tmp_path: Path) -> None:
    home = Home(tmp_path)
    home.others.accept(stamped(Places(map="home", places=(), no_go=()), 0, 0, "another"))
    home.turn()
    assert str(home.ask(BATH, 1).reason).startswith("two processes keep the places of this robot; see both")
    home.turn(3.1)
    assert home.ask(BATH, 2).done


def test_what_ends_no_service_is_refused(tmp_path: Path) -> None:
    home = Home(tmp_path)
    home.turn()
    short = PlaceForbid(x=1.00051, y=1.00051, end_x=1.00849, end_y=1.00849)
    assert str(home.ask(short, 1).reason).startswith("both ends of the line are one point")
    home.path.symlink_to(home.path)
    home.write = write_file_durably
    home.turn()
    assert "symbolic links" in home.faults["file"]
    assert "symbolic links" in str(home.ask(BATH, 2).reason)
    with pytest.raises(OSError, match="symbolic links"):
        write_file_durably(home.path, b"")
