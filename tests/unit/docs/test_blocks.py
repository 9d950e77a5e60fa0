"""Each command in a fenced block of README and docs is one that there is, with words that it takes.

A command of `giraff` that asks files is run. One that asks a robot is run where there is none, and gets as far as
saying so. One whose act is a test of its own is parsed. What is no `giraff` is in the table of outside.py.
"""

import re
from functools import cache
from pathlib import Path
from shutil import copy, copytree
from typing import Final

import pytest
import typer

import giraff_cli.run.begin
from tests.rules.repository import ROOT
from tests.unit.cli.quiet_network import alone, meet
from tests.unit.cli.test_any_command import ASKING, ROBOTLESS, whole_commands
from tests.unit.cli.typed import Giraff, typed
from tests.unit.docs.blocks import PAGES, Command, blocks, commands, hidden, mentioned, split
from tests.unit.docs.outside import OUTSIDE
from tests.unit.replay.drive import DRIVE, begin_of_the_drive

DATA: Final = ROOT / "tests" / "data" / "optiodom"
KNOWN: Final = cache(whole_commands)
GIRAFF: Final = {"giraff", ".venv/bin/giraff", "/opt/giraff/bin/giraff"}
IN_DOCKER: Final = ("docker-compose", "run", "--rm", "giraff")
RUN: Final = {
    "calibrate odometry": "--fit",
    "camera board": "",
    "encoder disk": "",
    "keys host": "",
    "keys init": "",
    "keys list": "",
    "localize": "--from",
    "map convert": "",
    "map show": "",
    "record": "--repair",
    "replay": "",
    "run": "",
    "tune balance": "",
}
"""Commands that need files alone, and the option with which they do. The robot of `run` is replaced."""
PLACEHOLDERS: Final = {"ADDRESS": "192.168.1.20", "HOST": "pi", "NAME": "anne", "ROBOT": "anne"}
FILES: Final = {
    "standing.mcap": DRIVE,
    "home.toml": ROOT / "deploy" / "worlds" / "flat.toml",
    "ground-floor.toml": ROOT / "deploy" / "worlds" / "flat.toml",
    "robot-b.csv": DATA / "square-b_metadata.csv",
    "monday/metadata.csv": DATA / "square-a_metadata.csv",
    **{f"monday/run-{n}.csv": DATA / f"square-a_run-0{n}.csv" for n in (1, 2, 4, 5)},
    **{f"tuesday/run-{n}.csv": DATA / f"square-a_run-0{n}.csv" for n in (3, 6)},
    **{f"{letter}.csv": DATA / f"square-b_run-0{n}.csv" for letter, n in (("a", 1), ("b", 4), ("c", 3))},
}
"""Files that the pages' reader has, and what they are here."""
NO_ROBOT: Final = re.compile(r"no robot (called \w+ )?is heard")
ENDS: Final = {
    "calibrate odometry": "the robot went 3.16 m and its wheels 16.01 m",  # these runs are of another robot
    "keys list": "desk: expires soon",
    "map make": "ground-floor.toml is there already",
    "record": "ended by the repair of cut-off.mcap",
    "stop": "nobody answered giraff/(giraff|robie)/estop/engage|put this host's bundle of `giraff keys host` there",
    "view": "no screen here|a recording is drawn to its end",
    "web": "no page service of this user runs on this host",
}
"""Where a command ends here otherwise than well or with no robot, and has understood its words."""
BEFORE: Final = {"docs/router.md": "giraff keys init"}
"""What the reader of a page has done before."""

ALREADY: Final[list[tuple[dict[str, str], tuple[str, ...]]]] = []
"""Commands that worked, with their variables. What asks a robot or replays the drive does the same on each page."""


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with copies of the reader's files, of which no command changes one in its place."""
    folder = tmp_path_factory.mktemp("files")
    copytree(ROOT / "deploy", folder / "deploy")
    for name, source in FILES.items():
        (folder / name).parent.mkdir(exist_ok=True)
        copy(source, folder / name)
    begin_of_the_drive(folder / "drive.mcap", 3_000_000_000)
    return folder


@pytest.fixture
def say(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path, files: Path) -> Giraff:
    """Type a command in a folder with the reader's files, on a network where no robot is."""
    for file in files.iterdir():
        (tmp_path / file.name).symlink_to(file)
    (tmp_path / "cut-off.mcap").write_bytes(DRIVE.read_bytes()[:300_000])
    alone(monkeypatch, tmp_path)
    monkeypatch.setattr(giraff_cli.run.begin, "drive", lambda _plan: 0)
    meet(monkeypatch)

    def say(variables: dict[str, str], *words: str) -> tuple[int, str, str]:
        with monkeypatch.context() as patch:
            for name, value in variables.items():
                patch.setenv(name, value)
            return typed(monkeypatch, capsys, *words)

    return say


def wrong_with(command: Command, say: Giraff) -> str:
    """Return what is wrong with it; nothing where it stands for something that works."""
    words = tuple(PLACEHOLDERS.get(word, word) for word in command.words)
    if words[:4] == IN_DOCKER:
        words = words[3:]
    if words[0] in GIRAFF:
        return _giraff(command, words[1:], say)
    if words[0] in OUTSIDE:
        return OUTSIDE[words[0]][1](words)
    return "no test knows this program: add it to OUTSIDE, with why no test starts it"


def _giraff(command: Command, words: tuple[str, ...], say: Giraff) -> str:
    known = KNOWN()
    length = next((n for n in (2, 1) if " ".join(words[:n]) in known), 0)
    path, rest = " ".join(words[:length]), list(words[length:])
    if not length:
        return "there is no such command"
    try:
        known[path].make_context(path, list(rest))
    except typer.TyperException as error:
        return error.format_message()
    runs = path in RUN and RUN[path] in {*rest, ""}
    asked = (command.variables, words)
    if asked in ALREADY and (not runs or path == "replay"):
        return ""
    if not runs and path not in ASKING:
        return "" if path in ROBOTLESS else "neither ASKING nor ROBOTLESS of test_any_command.py has it"
    takes = {name for parameter in known[path].params for name in parameter.opts}
    ends = ("--for", "4") if not runs and "--for" in takes - set(rest) else ()
    code, out, complaint = say(command.variables, *words, *ends)
    said = complaint + out
    is_well = code == 0 if runs else bool(NO_ROBOT.search(said))
    if not is_well and not (path in ENDS and re.search(ENDS[path], said)):
        return said
    ALREADY.append(asked)
    return ""


@pytest.mark.parametrize("page", [page for page in PAGES if commands(page)])
def test_each_command_of_a_page_is_one_that_works(page: str, say: Giraff) -> None:
    before = split("", BEFORE.get(page, ""))
    found = [f"{each}\n    {wrong}" for each in (*before, *commands(page)) if (wrong := wrong_with(each, say))]
    assert not found, "\n".join(found)


@pytest.mark.parametrize("path", KNOWN())
def test_the_example_in_the_help_of_each_command_works(path: str, say: Giraff) -> None:
    [command] = split(f"giraff {path} --help", KNOWN()[path].epilog.removeprefix("Example: "))
    assert " ".join(command.words).startswith(f"giraff {path}")
    before = split("", "giraff keys init" if path in {"keys host", "keys list"} else "")
    assert [wrong for each in (*before, command) if (wrong := wrong_with(each, say))] == []


def misnamed(command: Command) -> str:
    """Return what is wrong with words in a text: they may be of a group, and leave out what a command needs."""
    if command.words[0] == "make":
        return OUTSIDE["make"][1](command.words)
    known, (name, *rest) = KNOWN(), command.words[1:]
    groups = {path.split()[0] for path in known if " " in path}
    path = f"{name} {rest[0]}" if name in groups and rest else name
    if path not in {*known, *groups, "COMMAND", "--help", "--version"}:
        return "there is no such command"
    takes = {"--help"} | {each for parameter in getattr(known.get(path), "params", ()) for each in parameter.opts}
    return ", ".join(f"it has no {word}" for word in rest if word.startswith("--") and word not in takes)


@pytest.mark.parametrize("page", [*PAGES, "CONTRIBUTING.md"])
def test_each_command_that_a_text_names_exists(page: str) -> None:
    assert [f"{each}: {wrong}" for each in mentioned(page) if (wrong := misnamed(each))] == []


def test_no_command_stands_where_no_test_sees_it() -> None:
    assert [line for page in PAGES for line in hidden(page)] == [], "give its block a language: sh or console"
    languages = {block.language for page in PAGES for block in blocks(page)}
    assert languages <= {"", "sh", "console", "toml", "python", "cpp"}


def test_no_row_of_the_tables_is_left_over() -> None:
    programs = {each.words[0] for page in PAGES for each in commands(page)}
    assert set(OUTSIDE) <= programs


@pytest.mark.parametrize(
    "line",
    [
        "giraff wach",
        "giraff topic echo odom --onec",
        "giraff run --file deploy/robots/none.toml",
        "giraff map show deploy/worlds/none.toml",
        "giraff odom set 1,2",
        "make rum",
        "make install ROLL=robot",
        "make install ROLE=rowboat",
        "make install ROLE=robot LOCK=web LOCK=wep",
        "make -C firmware flash BOARD=bass",
        "docker-compose run --rm giraff checks wheels",
        "docker-compose logs wach",
        "sudo systemctl restart giraff@bass",
        "python -m giraff_helth base",
        "pip install '.[viewers]'",
        "cp deploy/env/desc.env .env",
        "rviz2",
    ],
)
def test_what_is_wrong_in_a_page_is_found(line: str, say: Giraff) -> None:
    [command] = split("a page", line)
    assert wrong_with(command, say)


@pytest.mark.parametrize("line", ["giraff wach", "giraff topic eco odom", "giraff view --wep", "make rum"])
def test_what_is_wrong_in_a_text_is_found(line: str) -> None:
    [command] = split("a page", line)
    assert misnamed(command)
