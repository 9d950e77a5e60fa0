"""A kind of drive, as a board, is one word: for its folders, in the robot file, and for the test of its contract."""

import re
from pathlib import Path
from typing import get_args, get_type_hints

import msgspec
import pytest

from giraff_base.config import KINDS, BaseConfig
from giraff_core.bounds import bounds_of
from giraff_core.robot import RobotConfig
from giraff_core.tuning import Tuning, live_fields
from giraff_node.config.robot_file import load
from giraff_ranger.config import RangerConfig
from giraff_schemas.boards import ALL_BOARDS, BaseBoardName, boards_chosen_in
from tests.rules.repository import ROOT, imported_by, name, sources

DRIVES = ROOT / "services" / "giraff_base" / "drives"
BODIES = ROOT / "services" / "giraff_sim" / "bodies"
BOARDS = ROOT / "firmware" / "boards"
CONTRACT = ROOT / "tests" / "unit" / "base" / "drives"
ONE_FIRMWARE = frozenset(
    ("WheelsFrame", "DriveFrame", "SpeedFrame", "ConfigureFrame", "EstopFrame", "DriveState", "SpeedFlag")
)
"""What the wire calls the frames and states of `firmware/base`."""
MAY_NAME_IT = re.compile(
    r"giraff_base/drives/|giraff_sim/bodies/|giraff_sim/control/|giraff_setup/(wheels|encoder)/|/wire\.py$"
)

MAY_IMPORT = r"giraff_base/(config|registry)\.py$|giraff_sim/dst/faults/robot\.py$|giraff_setup/balancer/"
"""The union, `giraff_base/config.py`; `giraff_base/registry.py`, which makes the drive; faults of the stock robot,
`giraff_sim/dst/faults/robot.py`; and what sets one kind up, `giraff_setup/balancer`.

MAY_NAME_IT has the others: each kind itself and `giraff_sim/bodies/registry.py`, which makes the body;
`giraff_sim/control`, which sets the wheels of a simulated robot; and `giraff_setup/wheels` and `encoder`.
"""
TAGS = "|".join(str(kind.__struct_config__.tag) for kind in KINDS)
CONFIGS = [kind.__name__ for kind in KINDS]
OF_A_KIND = re.compile(rf"giraff_(base\.drives|sim\.bodies)\.({TAGS})\b|.*\.({'|'.join(CONFIGS)})$")


def folders(parent: Path) -> set[str]:
    return {init.parent.name for init in parent.glob("*/__init__.py")}


def tags() -> set[str]:
    return {str(kind.__struct_config__.tag) for kind in KINDS}


def test_each_kind_has_its_folders_its_tag_and_its_contract() -> None:
    tests = [path for path in CONTRACT.glob("test_*.py") if "(AnyDrive)" in path.read_text(encoding="utf-8")]
    assert folders(DRIVES) == folders(BODIES) == tags() == {path.stem.removeprefix("test_") for path in tests}


def test_each_board_has_its_folder_its_number_and_its_word_in_the_robot_file() -> None:
    names = [board.name for board in ALL_BOARDS]
    assert sorted(names) == sorted(path.parent.name for path in BOARDS.glob("*/board.mk"))
    assert len({board.number for board in ALL_BOARDS}) == len(names)
    words = {"[base.drive]": get_args(BaseBoardName), "[ranger]": get_args(get_type_hints(RangerConfig)["board"])}
    chosen = {table: tuple(boards_chosen_in(table)) for table in words}
    assert chosen == words


@pytest.mark.parametrize("kind", KINDS)
def test_each_is_fixed_or_checked_while_base_runs_and_has_a_range_for_each_number(kind: type[msgspec.Struct]) -> None:
    assert set(live_fields(kind).values()) <= {Tuning.READ_ONLY, Tuning.CHECKED}
    numbers = {name for name, hint in get_type_hints(kind).items() if hint in (int, float)}
    assert numbers == bounds_of(kind).keys()


@pytest.mark.parametrize("path", [ROOT / "deploy" / "robot.toml", *(ROOT / "deploy" / "robots").glob("*.toml")])
def test_each_robot_file_of_the_tree_is_sound(path: Path) -> None:
    given = {"GIRAFF_CONFIG": str(path)}
    assert load("base", BaseConfig, given).drive.board_type.frames
    assert load("robot", RobotConfig, given).sensors


def named(path: Path) -> frozenset[str]:
    """Return what of one firmware a module names."""
    imported = imported_by(path.read_text(encoding="utf-8"), *ONE_FIRMWARE)
    return ONE_FIRMWARE & {each.rpartition(".")[2] for each in imported}


def test_nobody_outside_names_the_wire_of_one_firmware() -> None:
    outside = [path for path in sources(".py", under=("schemas", "services")) if not MAY_NAME_IT.search(name(path))]
    assert {name(path): named(path) for path in outside if named(path)} == {}


def of_a_kind(path: Path) -> set[str]:
    """Return what a module imports from the folders of a kind, and the configuration of one by whatever way."""
    imported = imported_by(path.read_text(encoding="utf-8"), "drives", "bodies", *CONFIGS)
    return set(filter(OF_A_KIND.match, imported))


def test_nobody_else_imports_from_the_folders_of_a_kind() -> None:
    """Everybody else asks the drive, its configuration or the body."""
    may = re.compile(rf"{MAY_NAME_IT.pattern}|{MAY_IMPORT}")
    others = [path for path in sources(".py", under=("schemas", "services")) if not may.search(name(path))]
    assert {name(path): found for path in others if (found := of_a_kind(path))} == {}


def test_a_planted_import_shows(tmp_path: Path) -> None:
    (path := tmp_path / "policy.py").write_text("from giraff_schemas.wire import Frame, SpeedFrame as asked")
    assert named(path) == {"SpeedFrame"}
    path.write_text(
        "from giraff_base.drives import balancer, dialogue\n"
        "from giraff_sim.bodies import balancer as body\n"
        "from giraff_base.config import KINDS, BalancerConfig\n"
    )
    planted = {"giraff_base.drives.balancer", "giraff_sim.bodies.balancer", "giraff_base.config.BalancerConfig"}
    assert of_a_kind(path) == planted
