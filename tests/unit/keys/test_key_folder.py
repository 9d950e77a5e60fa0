"""Keys on disk: what fails leaves all as it was. Killed halfway: tests/functional/keys/test_interruptions.py."""

import errno
import os
from pathlib import Path

import pytest

from giraff_keys import folder as key_folder
from giraff_keys.folder import holding
from tests.unit.keys.folders import authority, bundle, contents


def full(*_arguments: object) -> None:
    raise OSError(errno.ENOSPC, "No space left on device")


@pytest.mark.parametrize("renew", [False, True])
def test_a_full_disk_leaves_all_as_it_was(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, *, renew: bool) -> None:
    folder = authority(tmp_path / "keys")
    if renew:
        bundle(folder)
    before = contents(tmp_path)
    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(OSError, match="No space left"):
        bundle(folder, renew=renew)
    assert contents(tmp_path) == before


def test_a_renewal_whose_last_step_fails_is_taken_back(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = authority(tmp_path / "keys")
    bundle(folder)
    before = contents(tmp_path)
    rename = Path.rename

    def fail(path: Path, target: Path) -> Path:
        if path.name.endswith("-new"):
            raise OSError(errno.EIO, "Input/output error")
        return rename(path, target)

    monkeypatch.setattr(Path, "rename", fail)
    with pytest.raises(OSError, match="Input/output error"):
        bundle(folder, renew=True)
    assert contents(tmp_path) == before


def test_a_disk_that_keeps_no_permissions_gets_no_key(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(key_folder, "is_readable_by_others", lambda _path: True)
    written: list[bytes] = []
    monkeypatch.setattr(os, "fsync", lambda file: written.append(Path(f"/proc/self/fd/{file}").resolve().name.encode()))
    with pytest.raises(OSError, match="file permissions do not hold here"):
        authority(tmp_path / "keys")
    assert b"ca.key" not in written
    assert [*tmp_path.iterdir()] == []


def test_only_its_own_leftovers_are_cleared_away(tmp_path: Path) -> None:
    for name in (".robot.old", ".keys", "keys.giraff-new"):
        (tmp_path / name).mkdir()
    (tmp_path / ".keys.giraff-new").mkdir()
    with holding(tmp_path):
        assert sorted(path.name for path in tmp_path.iterdir()) == [".keys", ".robot.old", "keys.giraff-new"]
