"""What `giraff frames` makes of transforms."""

import math
import re
from collections.abc import Sequence
from html import unescape
from pathlib import Path

import msgspec
import pytest

import giraff_cli.frames.show
from giraff_cli.frames.tree import Frames, dot, draw, faults_of, place, pose_text, tree_of
from giraff_core.kinematics.frames import FrameTree
from giraff_schemas.frames import Transform
from giraff_schemas.topics import alive_key
from tests.unit.cli.quiet_network import meet
from tests.unit.cli.typed import Giraff


def frame(parent: str, child: str) -> Transform:
    return Transform(parent=parent, child=child, x=0.0, y=0.0, yaw=0.0, fixed=True)


@pytest.mark.parametrize(
    ("told", "said"),
    [
        ([frame("odom", "base_link"), frame("base_link", "rear")], []),
        ([frame("odom", "base_link"), frame("map", "base_link")], ["in map and in odom", "map, odom are in none"]),
        ([frame("base_link", "rear")], []),
        ([frame("odom", "base_link"), frame("chassis", "rear")], ["hang together nowhere: chassis, odom"]),
        ([frame("a", "b"), frame("b", "a")], ["they are in each other"]),
    ],
)
def test_what_is_no_tree_is_told(told: list[Transform], said: list[str]) -> None:
    faults = faults_of(told)
    assert len(faults) == len(said)
    assert all(words in fault for words, fault in zip(said, faults, strict=True))


def test_a_name_may_hold_anything() -> None:
    drawn = dot(Frames(robot='a"b', frames=[frame('x"', "y\\")], faults=[]))
    assert drawn.splitlines()[0] == 'digraph "a\\"b" {'
    assert '"x\\"" -> "y\\\\"' in drawn


HEAD = [
    msgspec.structs.replace(frame("odom", "base_link"), x=1.0, yaw=math.pi / 2, fixed=False),
    msgspec.structs.replace(frame("base_link", "laser"), x=-0.115, z=0.226),
    msgspec.structs.replace(frame("laser", "<lens>"), z=0.1, pitch=math.radians(-10.0)),
]
FOUND = Frames(robot="sim-test", frames=HEAD, faults=[])


def test_a_place_tells_of_z_roll_and_pitch_what_is_not_0() -> None:
    assert [place(each) for each in HEAD] == [
        "x 1.000 m, y 0.000 m, yaw 90.0°",
        "x -0.115 m, y 0.000 m, z 0.226 m, yaw 0.0°",
        "x 0.000 m, y 0.000 m, z 0.100 m, pitch -10.0°, yaw 0.0°",
    ]


def test_a_pose_is_told_in_full() -> None:
    assert pose_text(FrameTree(HEAD).lookup("odom", "<lens>")).splitlines() == [
        "<lens> in odom, now",
        "x        1.000 m",
        "y       -0.115 m",
        "z        0.326 m",
        "roll    0.0000 rad     0.00°",
        "pitch  -0.1745 rad   -10.00°",
        "yaw     1.5708 rad    90.00°",
    ]
    assert pose_text(HEAD[1]).startswith("laser in base_link\n")


def texts(drawn: str) -> list[str]:
    return [unescape(each) for each in re.findall(r"<text [^>]*>([^<]*)</text>", drawn)]


def test_a_drawing_has_each_frame_and_where_it_is() -> None:
    drawn = draw(FOUND)
    words = texts(drawn)
    assert words[0] == "frames of sim-test"
    assert {"odom", "base_link", "laser", "<lens>"} <= set(words)
    assert "x -0.115  y 0.000  z 0.226 m" in words
    assert "roll 0.0°  pitch -10.0°  yaw 0.0°" in words
    assert (words.count("fixed"), words.count("now")) == (2, 1)
    assert drawn.count("marker-end") == len(HEAD)


@pytest.mark.parametrize(
    "told", [[*HEAD, frame("map", "base_link")], [frame("a", "b"), frame("b", "a")], [frame("a", "b\x1b[2J\0")]]
)
def test_whatever_is_told_can_be_drawn(told: list[Transform]) -> None:
    faults = faults_of(told)
    words = texts(draw(Frames(robot="sim-test", frames=told, faults=faults)))
    assert words[1 : 1 + len(faults)] == faults
    assert len(tree_of(told)) == len({each.parent for each in told} - {each.child for each in told})


@pytest.fixture
def say(monkeypatch: pytest.MonkeyPatch, giraff: Giraff, tmp_path: Path) -> Giraff:
    """Types `giraff frames` where these frames are told: exit code, output and complaint."""
    monkeypatch.chdir(tmp_path)
    meet(monkeypatch, alive_key("sim-test", "base", "b0"))
    told = [*HEAD]
    monkeypatch.setattr(giraff_cli.frames.show, "_ask", lambda *_: told)

    def say(*words: str, more: Sequence[Transform] = ()) -> tuple[int, str, str]:
        told.extend(more)
        return giraff("frames", *words)

    return say


def test_the_pose_of_one_in_another_is_printed(say: Giraff) -> None:
    code, output, complaint = say("--from", "laser", "--to", "odom")
    assert (code, complaint) == (0, "")
    assert output.startswith("laser in odom, now\nx        1.000 m\n")
    code, output, _ = say("--from", "odom", "--to", "base_link", "--json")
    pose = msgspec.json.decode(output, type=Transform)
    assert (code, pose.parent, pose.child, pose.fixed) == (0, "base_link", "odom", False)
    assert (pose.x, pose.y, pose.yaw) == pytest.approx((0.0, 1.0, -math.pi / 2))


def test_where_localization_tells_of_the_map_the_tree_begins_there(say: Giraff) -> None:
    code, _, complaint = say("--from", "base_link", "--to", "map")
    assert (code, "check that giraff_localization runs" in complaint) == (2, True)
    placed = msgspec.structs.replace(frame("map", "odom"), x=4.0, yaw=math.pi / 2, fixed=False)
    code, output, _ = say("--from", "base_link", "--to", "map", more=[placed])
    assert code == 0
    assert output.startswith("base_link in map, now\nx        4.000 m\ny        1.000 m\n")
    code, output, _ = say(more=[placed])
    assert (code, output.splitlines()[0]) == (0, "map")


def test_what_cannot_be_told_says_why(say: Giraff) -> None:
    code, _, complaint = say("--from", "lasre", "--to", "odom")
    assert code == 2
    assert "no frame is called 'lasre', those that are known: <lens>, base_link, laser, odom" in complaint
    code, output, complaint = say("--from", "laser", "--to", "odom", more=[frame("map", "door")])
    assert (code, output) == (1, "")
    assert "map, odom are in none that is told" in complaint


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (("--from", "laser"), "--from needs --to: the pose of one frame in another"),
        (("--to", "laser"), "--to needs --from"),
        (("--dot", "--svg", "x.svg"), "give one of --svg, --dot, and --from with --to"),
        (("--from", "laser", "--to", "odom", "--dot"), "give one of --svg, --dot"),
    ],
)
def test_what_does_not_go_together_is_refused(say: Giraff, words: Sequence[str], says: str) -> None:
    code, output, complaint = say(*words)
    assert (code, output) == (2, "")
    assert says in complaint


def test_it_is_drawn_into_a_file_and_never_over_what_is_none(say: Giraff, tmp_path: Path) -> None:
    code, output, _ = say("--svg", "frames.svg")
    assert (code, output.count("\n")) == (0, 4)
    assert texts((tmp_path / "frames.svg").read_text()) == texts(draw(FOUND))
    for path in ("/dev/null", "nowhere/frames.svg", "."):
        code, output, complaint = say("--svg", path)
        assert (code, output) == (2, "")
        assert f"--svg {path}: cannot be written: " in complaint
        assert "name another file" in complaint
    assert Path("/dev/null").is_char_device()
