"""What is kept across restarts: whole or not at all, and stopped where it says nothing.

The thread that writes it: tests/functional/node/test_saving.py.
"""

import errno
import os
from pathlib import Path

import pytest

from giraff_core.estop.latch import LATCH_FILE, RELEASED, EStopLatch, latch_bytes, load_latch
from giraff_node.process.state import Folder, state_directory, write_file_durably, write_latch
from giraff_schemas.trouble import NO_TROUBLE, Trouble

LOST = 41
ENGAGED = EStopLatch(engaged=True, id=7, by="keyboard", reason=Trouble("space bar"))
WHOLE = latch_bytes(EStopLatch(engaged=False, id=7, by="carer", reason=NO_TROUBLE)).strip()


def read_latch(directory: Path) -> EStopLatch:
    return load_latch(Folder(directory), LOST)


@pytest.mark.parametrize(
    ("environment", "expected"),
    [
        ({"STATE_DIRECTORY": "/var/lib/giraff"}, "/var/lib/giraff"),
        ({"STATE_DIRECTORY": "/var/lib/giraff:/var/lib/other", "HOME": "/home/g"}, "/var/lib/giraff"),
        ({"STATE_DIRECTORY": "", "XDG_STATE_HOME": "/x", "HOME": "/home/g"}, "/x/giraff/anna"),
        ({"XDG_STATE_HOME": "relative", "HOME": "/home/g"}, "/home/g/.local/state/giraff/anna"),
        ({"HOME": "/home/g"}, "/home/g/.local/state/giraff/anna"),
        ({}, "/.local/state/giraff/anna"),
    ],
)
def test_where_state_is_kept(environment: dict[str, str], expected: str) -> None:
    assert state_directory("anna", environment) == Path(expected)


@pytest.mark.parametrize("latch", [RELEASED, ENGAGED])
def test_what_is_written_is_read(tmp_path: Path, latch: EStopLatch) -> None:
    directory = tmp_path / "not" / "there" / "yet"
    write_latch(directory, latch)
    assert read_latch(directory) == latch
    assert [path.name for path in directory.iterdir()] == [LATCH_FILE]


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (None, "missing, as at a first start"),
        (b"", "damaged"),
        (WHOLE[:20], "damaged"),
        (bytes(len(WHOLE)), "damaged"),
        (WHOLE + b"}", "damaged"),
        (b"\xff" + WHOLE, "damaged"),
        (b"[" * 100_000, "damaged"),
        (b"null", "damaged"),
        (WHOLE.replace(b'"engaged":false,', b""), "damaged"),
        (WHOLE.replace(b'"reason":{"what":"","remedy":"","action":"","argument":""},', b""), "damaged"),
        (WHOLE.replace(b'{"what":"","remedy":"","action":"","argument":""}', b'""'), "damaged"),
        (WHOLE.replace(b'"action":""', b'"action":"drive"'), "damaged"),
        (WHOLE.replace(b"false", b'"false"'), "damaged"),
        (WHOLE.replace(b"false", b"0"), "damaged"),
        (WHOLE.replace(b"7", b"7.5"), "damaged"),
        (WHOLE.replace(b"7", b"-7"), "damaged"),
        (WHOLE.replace(b"7", b"7" * 40), "damaged"),
        (WHOLE.replace(b"by", b"who"), "damaged"),
        (WHOLE.replace(b"{", b'{"extra":1,'), "damaged"),
    ],
    ids=str,
)
def test_a_file_that_says_nothing_clear_is_a_latch(tmp_path: Path, content: bytes | None, words: str) -> None:
    (tmp_path / LATCH_FILE).write_bytes(WHOLE)
    assert not read_latch(tmp_path).engaged
    (tmp_path / LATCH_FILE).unlink()
    if content is not None:
        assert content != WHOLE
        (tmp_path / LATCH_FILE).write_bytes(content)
    latch = read_latch(tmp_path)
    assert latch.engaged
    assert words in str(latch.reason)
    assert str(tmp_path / LATCH_FILE) in str(latch.reason)
    assert latch.reason.action == "release"
    assert latch.id == LOST


def test_a_file_that_cannot_be_read_is_a_latch(tmp_path: Path) -> None:
    (tmp_path / LATCH_FILE).mkdir()
    latch = read_latch(tmp_path)
    assert latch.engaged
    assert "cannot be read: Is a directory" in str(latch.reason)


@pytest.mark.parametrize(("owner", "fails"), [(os, "fsync"), (Path, "replace")])
def test_a_write_that_fails_leaves_the_old_file_whole(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, owner: object, fails: str
) -> None:
    write_latch(tmp_path, ENGAGED)

    def no_space(*_: object) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), ".hidden")

    monkeypatch.setattr(owner, fails, no_space)
    with pytest.raises(OSError, match=f"No space left on device: '{tmp_path}/{LATCH_FILE}'$"):
        write_latch(tmp_path, RELEASED)
    assert read_latch(tmp_path) == ENGAGED
    assert [path.name for path in tmp_path.iterdir()] == [LATCH_FILE]


def test_the_file_is_on_disk_before_it_has_its_name_and_the_name_before_it_is_done(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    done: list[str] = []
    fsync, replace = os.fsync, Path.replace

    def note_fsync(descriptor: int) -> None:
        done.append("fsync " + Path(f"/proc/self/fd/{descriptor}").readlink().name)
        fsync(descriptor)

    def note_replace(self: Path, target: Path) -> Path:
        done.append(f"replace {target.name}")
        return replace(self, target)

    monkeypatch.setattr(os, "fsync", note_fsync)
    monkeypatch.setattr(Path, "replace", note_replace)
    write_file_durably(tmp_path / "file", b"content")
    assert done == [f"fsync .file.{os.getpid()}", "replace file", f"fsync {tmp_path.name}"]


def test_a_file_keeps_its_permissions_and_its_links(tmp_path: Path) -> None:
    target, link = tmp_path / "target", tmp_path / "link"
    target.write_text("before")
    target.chmod(0o640)
    link.symlink_to(target)
    write_file_durably(link, b"after")
    assert (target.read_text(), link.is_symlink()) == ("after", True)
    assert target.stat().st_mode & 0o7777 == 0o640
    assert sorted(path.name for path in tmp_path.iterdir()) == ["link", "target"]


def test_what_is_no_plain_file_stays(tmp_path: Path) -> None:
    """Whoever is root and names /dev/null would take it from every program of the machine."""
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    with pytest.raises(OSError, match="no plain file"):
        write_file_durably(pipe, b"content")
    assert pipe.is_fifo()
    assert list(tmp_path.iterdir()) == [pipe]
