"""Verbs of a wheel that lack something say what, and what to type."""

from pathlib import Path

import pytest

from giraff_cli import options, start
from giraff_node.process import libraries
from giraff_node.process.libraries import remedy
from tests.unit.cli.typed import Giraff

_TREE = "the simulated robot needs the repository's tree, which is not here; clone the repository, then make run in it"

_LOCALIZE = ("localize", "--map", "hall.toml")


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("run", "--camera"), f"giraff run: {_TREE}"),
        (("dst", "--seeds", "3"), f"giraff dst: {_TREE}"),
        (("check", "wheels"), f"giraff check wheels: the library serial is missing; {remedy('cli,serial')}"),
        (("view",), f"giraff view: the library rerun is missing; {remedy('viewer,cli')}"),
        (_LOCALIZE, f"giraff localize: the library numpy is missing; {remedy('cli,localization')}"),
        (
            (*_LOCALIZE, "--from", "a.mcap"),
            f"giraff localize: the library mcap is missing; {remedy('cli,localization,record')}",
        ),
        (("vision", "--from", "a.avi"), f"giraff vision: the library cv2 is missing; {remedy('camera,cli,record')}"),
        (
            ("calibrate", "odometry"),
            f"giraff calibrate odometry: the library numpy is missing; {remedy('analysis,cli')}",
        ),
        (("keys", "init"), f"giraff keys: the library cryptography is missing; {remedy('cli,keys')}"),
    ],
)
def test_it_is_told_in_a_line(
    words: tuple[str, ...], told: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, giraff: Giraff
) -> None:
    """Of the libraries this one alone is missing."""
    missing = told.partition("the library ")[2].partition(" ")[0]
    monkeypatch.setattr(libraries, "TREE", tmp_path)
    monkeypatch.setattr(options, "find_spec", lambda name: None if name == missing else name)
    monkeypatch.chdir(tmp_path)
    assert giraff(*words) == (2, "", f"{told}\n")


def test_a_wheel_without_its_extras_says_which_it_wants(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(start, "find_spec", lambda _name: None)
    with pytest.raises(SystemExit) as end:
        start.main()
    assert (end.value.code, capsys.readouterr().err) == (2, f"giraff: the library typer is missing; {remedy('cli')}\n")


@pytest.mark.parametrize(
    ("kept", "environment", "extras", "told"),
    [
        ("pyproject.toml", ".venv", "viewer,cli", "in the clone: make viewer"),
        ("pyproject.toml", ".venv", "cli,sim,camera", "in the clone: make camera"),
        ("pyproject.toml", ".venv", "cli,web", "in the clone: make setup"),
        ("pyproject.toml", "mine", "viewer,cli", "in the clone: pip install '.[viewer,cli]'"),
        ("mine/made-of", "mine", "camera", "docs/install.md says which LOCK of make install has it"),
        ("none", "mine", "cli", "pip install 'giraff[cli] @ file:///FOLDER/giraff-VERSION-py3-none-any.whl'"),
    ],
)
def test_what_brings_a_library_goes_by_where_the_code_lies(
    kept: str, environment: str, extras: str, told: str, tmp_path: Path
) -> None:
    (tmp_path / "mine").mkdir()
    (tmp_path / kept).touch()
    assert remedy(extras, tmp_path, tmp_path / environment) == told
