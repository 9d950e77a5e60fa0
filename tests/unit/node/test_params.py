"""The parameters of one service: what may be set, what is kept, and what a service says that was asked for them."""

from pathlib import Path
from typing import Annotated, Any
from unittest.mock import MagicMock

import msgspec
import pytest

from giraff_base.drives.wheels.config import WheelsConfig
from giraff_cli.param.format import Shown
from giraff_core.bounds import require_positive
from giraff_core.io import Inbox
from giraff_core.parameters.server import ParameterServer
from giraff_core.parameters.table import MistypedError, ParamError, Parameters
from giraff_core.tuning import Tuning
from giraff_node.process.state import Folder
from giraff_schemas.params import Param, ParamSave, ParamSet
from giraff_schemas.trouble import NO_TROUBLE
from tests.support.robots import BASE, ROBOT
from tests.unit.node.asked import Asked


class Config(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    margin: Annotated[float, Tuning.RAISE_ONLY] = 0.25
    """m kept
    free."""
    fast: Annotated[float | None, Tuning.LOWER_ONLY] = 1.5
    noise: Annotated[int, Tuning.FREE] = 3
    """Counts."""
    port: Annotated[str, Tuning.READ_ONLY] = "/dev/tty"

    def __post_init__(self) -> None:
        require_positive(self, "margin")
        if self.noise > 100:
            raise ValueError(f"noise is {self.noise}: it must be 100 at most")


class Inner(msgspec.Struct, frozen=True, kw_only=True, tag_field="type", tag="inner"):
    gain: Annotated[float, Tuning.CHECKED] = 3.0
    floor: Annotated[float, Tuning.RAISE_ONLY] = 1.0
    size: Annotated[float, Tuning.READ_ONLY] = 1.0

    def __post_init__(self) -> None:
        if not 2.0 < self.gain < 9.0:
            raise ValueError("gain must be within 2..9")


class Outer(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    drive: Annotated[Inner, Tuning.READ_ONLY] = Inner()
    noise: Annotated[int, Tuning.FREE] = 3


@pytest.fixture
def params() -> Parameters[Config]:
    return Parameters("guard", Config(), ROBOT)


def described(params: Parameters[Config], name: str) -> Param:
    [param] = params.describe((name,))
    return param


def test_what_is_set_is_another_configuration(params: Parameters[Config]) -> None:
    before = params.config
    params.set("margin", "0.5")
    params.set("fast", 1)
    params.set("noise", 7)
    assert before == Config()
    assert params.config == Config(margin=0.5, fast=1.0, noise=7)
    params.set("fast", None)
    assert params.config.fast is None


@pytest.mark.parametrize(
    ("name", "value", "why"),
    [
        (
            "margin",
            0.1,
            "guard.margin 0.1 is looser than 0.25: loosening takes the robot file, standstill and a restart",
        ),
        ("margin", 0, "margin is 0.0: it must be a positive number"),
        ("margin", None, "margin must be a number, and is none"),
        ("margin", {"a": 1}, "margin must be a number, and is a table of fields"),
        ("fast", 1.6, "looser than 1.5"),
        ("noise", 101, "it must be 100 at most"),
        ("noise", "-9223372036854775809", "guard.noise -9223372036854775809: -9223372036854775809 is beyond 64 bits"),
        ("noise", 2.5, "noise must be a whole number"),
        ("port", "/dev/null", "guard.port cannot change while the service runs: it takes the robot file and a restart"),
        ("robot.track_width", 1.0, "is shared by all services"),
        ("robot.track", 1.0, "guard has no parameter robot.track; there are: margin, fast, noise, port"),
        ("marign", 1.0, "guard has no parameter marign; did you mean guard.margin?"),
        ("", 1.0, "there are: margin"),
    ],
)
def test_what_is_refused_changes_nothing(params: Parameters[Config], name: str, value: Any, why: str) -> None:
    with pytest.raises(ParamError) as refused:
        params.set(name, value)
    assert why in str(refused.value)
    is_ruled = any(word in why for word in ("looser", "cannot change", "shared"))
    assert isinstance(refused.value, MistypedError) is not is_ruled
    assert params.config == Config()


def test_what_is_not_known_is_not_loosened() -> None:
    params = Parameters("guard", Config(fast=None), ROBOT)
    with pytest.raises(ParamError, match="1 is looser than none"):
        params.set("fast", 1.0)


def test_a_tightening_is_taken_back_as_far_as_the_robot_file_goes(params: Parameters[Config]) -> None:
    params.set("margin", 0.5)
    params.set("margin", 0.3)
    params.set("margin", 0.25)
    with pytest.raises(ParamError, match=r"looser than 0\.25"):
        params.set("margin", 0.24)


def test_what_was_saved_comes_again_unless_the_robot_file_is_tighter() -> None:
    params = Parameters("guard", Config(margin=0.4), ROBOT)
    ignored = params.restore({"margin": 0.3, "noise": 9, "port": "/dev/null", "gone": 1, "fast": "x"})
    assert params.config == Config(margin=0.4, noise=9)
    assert params.saved == {"noise": 9}
    assert [why.partition(":")[0].split()[0] for why in ignored] == [
        "guard.margin",
        "guard.port",
        "guard",
        "guard.fast",
    ]
    assert params.unknown == ("gone",)


@pytest.mark.parametrize(
    ("saved", "lost"), [('{"margin": 0.1}', False), ('{"gone": 1, "noise": 9}', True), ("{ torn", True)]
)
def test_a_saved_name_that_nobody_knows_or_a_torn_file_may_be_a_lost_limit(
    tmp_path: Path, saved: str, lost: bool
) -> None:
    (tmp_path / "params").mkdir()
    (tmp_path / "params" / "guard.json").write_text(saved)
    params = Parameters("guard", Config(margin=0.4), ROBOT)
    server = ParameterServer("guard", "guard-1", "host", params, Folder(tmp_path), print)
    assert server.fault
    assert server.lost == (server.fault if lost else NO_TROUBLE)
    assert server.fault.remedy.endswith("remove the file, and restart giraff_guard")
    assert server.fault.what.endswith(": gone = 1") == ("gone" in saved)


def test_only_what_is_not_the_robot_files_is_saved(params: Parameters[Config]) -> None:
    params.set("margin", 0.5)
    params.set("noise", 9)
    assert params.to_save(()) == {"margin": 0.5, "noise": 9}
    assert params.to_save(("noise",)) == {"noise": 9}
    params.saved = params.to_save(())
    params.set("margin", 0.25)
    assert params.to_save(("noise",)) == {"margin": 0.5, "noise": 9}
    assert params.to_save(()) == {"noise": 9}
    with pytest.raises(ParamError, match=r"did you mean guard\.noise"):
        params.to_save(("nose",))


def test_it_says_what_each_is_and_whether_it_lasts(params: Parameters[Config]) -> None:
    assert described(params, "margin") == Param(
        name="margin", value=0.25, filed=0.25, saved=True, kind="float", live="up", doc="m kept free."
    )
    assert (described(params, "fast").kind, described(params, "fast").doc) == ("float | None", "")
    params.set("margin", 0.5)
    assert (described(params, "margin").value, described(params, "margin").saved) == (0.5, False)
    params.saved = params.to_save(())
    assert described(params, "margin").saved
    params.set("margin", 0.25)
    assert not described(params, "margin").saved  # 0.5 comes again
    names = [param.name for param in params.describe()]
    assert names[:5] == ["margin", "fast", "noise", "port", "robot.name"]
    shared = described(params, "robot.footprint_radius")
    assert (shared.live, shared.value) == ("fixed", 0.3)
    assert shared.doc == "m: a disc about `base_link` that holds the whole robot."


class Faded(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Whose fields ask for each other."""

    proof: Annotated[float, Tuning.LOWER_ONLY] = 10.0
    fade: Annotated[float, Tuning.LOWER_ONLY] = 20.0
    noise: Annotated[int, Tuning.FREE] = 3

    def __post_init__(self) -> None:
        if self.proof >= self.fade:
            raise ValueError("proof must be below fade")


@pytest.fixture
def faded() -> Parameters[Faded]:
    """With both tightened."""
    params = Parameters("guard", Faded(), ROBOT)
    params.set("proof", 5)
    params.set("fade", 8)
    return params


def test_what_is_saved_stands_in_the_order_of_the_fields(faded: Parameters[Faded]) -> None:
    faded.set("noise", 4)
    assert [*faded.to_save(("noise", "fade", "proof"))] == ["proof", "fade", "noise"]


@pytest.mark.parametrize("gone", [{}, {"gone": 1}])
def test_what_asks_for_each_other_comes_again_whatever_the_order(gone: dict[str, int]) -> None:
    params = Parameters("guard", Faded(), ROBOT)
    saved = {"fade": 8.0, "proof": 5.0}
    assert len(params.restore({**gone, **saved})) == len(gone)
    assert params.config == Faded(proof=5.0, fade=8.0)
    assert params.saved == saved


def test_what_would_not_count_after_a_restart_is_not_saved(faded: Parameters[Faded]) -> None:
    with pytest.raises(ParamError) as refused:
        faded.to_save(("fade",))
    assert str(refused.value) == (
        "after a restart it would not count: guard.fade 8.0: proof must be below fade; save all of guard"
    )
    faded.saved = faded.to_save(("proof",))
    assert faded.to_save(("fade",)) == {"proof": 5.0, "fade": 8.0}


def test_fields_of_an_inner_table_are_set_by_their_names() -> None:
    params = Parameters("base", Outer(), ROBOT)
    params.set("drive.gain", 2.5)  # no side of it is looser
    params.set("drive.gain", 8)
    params.set("drive.floor", 2.0)
    assert params.config == Outer(drive=Inner(gain=8.0, floor=2.0))
    for name, value, why in (
        ("drive.gain", 9.5, "base.drive.gain 9.5: drive: gain must be within 2..9$"),
        ("drive.gain", "nan", "gain must be within"),
        ("drive.floor", 0.5, "looser than 1"),
        ("drive.size", 2.0, "base.drive.size cannot change"),
        ("drive.gian", 2.0, "did you mean base.drive.gain"),
        ("drive", {}, "it takes the robot file and a restart"),
    ):
        with pytest.raises(ParamError, match=why):
            params.set(name, value)
    assert params.config == Outer(drive=Inner(gain=8.0, floor=2.0))
    [gain] = params.describe(("drive.gain",))
    assert (gain.value, gain.filed, gain.saved, gain.live) == (8.0, 3.0, False, "checked")
    assert Shown("base", "pc", gain).sentence() == (
        "base.drive.gain 8 (robot file: 3; until the service restarts, and never saved)"
    )


def test_what_is_only_checked_is_never_saved_nor_restored() -> None:
    params = Parameters("base", Outer(), ROBOT)
    params.set("drive.gain", 8.0)
    params.set("drive.floor", 2.0)
    assert params.to_save(()) == {"drive.floor": 2.0}
    assert params.unsaved == ("drive.gain",)
    with pytest.raises(ParamError, match=r"base\.drive\.gain is never saved: .* so write it there"):
        params.to_save(("drive.gain",))
    after = Parameters("base", Outer(), ROBOT)
    assert len(after.restore({"drive.gain": 8.0, "drive.floor": 2.0})) == 1
    assert after.config == Outer(drive=Inner(floor=2.0))


def test_a_drive_is_a_row_a_field_and_fixed() -> None:
    params = Parameters("base", BASE, ROBOT)
    rows = {param.name: param for param in params.describe() if param.name.startswith("drive")}
    assert list(rows) == [f"drive.{field}" for field in WheelsConfig.__struct_fields__]
    row = rows["drive.max_level"]
    assert (row.value, row.filed, row.saved, row.kind, row.live) == (70, 70, True, "int", "fixed")
    assert "of 255" in row.doc
    for name in ("drive.max_level", "drive"):
        with pytest.raises(ParamError, match="it takes the robot file and a restart"):
            params.set(name, 60)


SETS = (("margin", 0.5), ("marign", 0.5), ("margin", 0.1))


def test_what_was_set_is_told_before_the_service_goes_by_it(params: Parameters[Config], tmp_path: Path) -> None:
    order: list[Any] = []
    server = ParameterServer("guard", "guard-1", "host", params, Folder(tmp_path), lambda *_: None)
    server.on_set = lambda answer: order.append([(param.name, param.value) for param in answer.params])
    sets: Inbox[Any] = Inbox(3)
    asked = [Asked(ParamSet(name=name, value=value, by="carer")) for name, value in SETS]
    for each in asked:
        sets.accept(each)
    server.turn(Inbox(1), sets, Inbox(1), lambda config: order.append(config.margin))
    assert [each.said and (each.said.done, each.said.mistyped) for each in asked] == [
        (True, False),
        (False, True),
        (False, False),
    ]
    assert order == [[("margin", 0.5)], 0.5]


def test_a_stranger_fills_neither_log_nor_disk_with_what_changes_nothing(tmp_path: Path) -> None:
    lines: list[str] = []
    written: list[bytes] = []
    params = Parameters("guard", Config(), ROBOT)
    server = ParameterServer(
        "guard", "guard-1", "host", params, Folder(tmp_path), lambda line, *told: lines.append(line % told)
    )
    server._writer = writer = MagicMock(save=written.append, outcome=lambda: "")
    sets, saves = Inbox[Any](1), Inbox[Any](1)
    by = "x" * 60_000

    def is_saved(margin: float) -> bool:
        sets.accept(to_set := Asked(ParamSet(name="margin", value=margin, by=by)))
        saves.accept(to_save := Asked(ParamSave(by=by)))
        for _ in range(2):
            server.turn(Inbox(1), sets, saves, lambda _: None)
        assert to_set.said is not None
        assert to_set.said.done
        assert to_save.said is not None
        return to_save.said.done

    assert all(is_saved(0.5) for _ in range(50))
    assert len(written) == 1
    assert [line.partition(" ")[0] for line in lines] == ["margin", "saved"]
    assert max(map(len, lines)) < 500
    writer.outcome = lambda: "no space"
    assert not is_saved(0.6)
    writer.outcome = lambda: ""
    assert is_saved(0.5)
    assert len(written) == 3, "after a failed write nobody knows what is on disk"
