"""The words of services, as the journal, containers and `giraff run` keep them, in one order."""

import os
import tempfile
from datetime import datetime
from pathlib import Path

import msgspec
import pytest

from giraff_cli.logs.entries import Merge, container_entry, journal_entry, json_of, line_of, run_text, since_moment
from giraff_cli.logs.sources import LogFile, Wanted, containers_in, runs
from giraff_tools.terminal.service_log import Entry

OWN = '{"time":"2023-11-14T22:13:20.120Z","level":"warning","service":"base","message":"low"}'
NOW = datetime(2026, 5, 31, 14, 45).astimezone().timestamp()


def journal(**fields: object) -> str:
    """A line of `journalctl -o json`."""
    known = {
        "__CURSOR": "s=7;i=4",
        "__REALTIME_TIMESTAMP": "1700000000125000",
        "_TRANSPORT": "stdout",
        "PRIORITY": "6",
        "SYSLOG_IDENTIFIER": "python",
        "_SYSTEMD_UNIT": "giraff@base.service",
        "MESSAGE": OWN,
    }
    return msgspec.json.encode(known | fields).decode()


OF_SYSTEMD: dict[str, object] = {"_TRANSPORT": "journal", "_SYSTEMD_UNIT": "init.scope", "UNIT": "giraff@web.service"}


@pytest.mark.parametrize(
    ("line", "entry"),
    [
        (journal(), Entry(1700000000.12, "base", "warning", "low")),
        (journal(MESSAGE="Traceback"), Entry(1700000000.125, "base", "error", "Traceback")),
        (journal(MESSAGE=[27, 91, 255]), Entry(1700000000.125, "base", "error", "\x1b[\ufffd")),
        (journal(MESSAGE=None), Entry(1700000000.125, "base", "error", "")),
        (
            journal(**OF_SYSTEMD, PRIORITY="4", MESSAGE="Failed with result 'exit-code'."),
            Entry(1700000000.125, "web", "warning", "Failed with result 'exit-code'."),
        ),
        (journal(__REALTIME_TIMESTAMP="9" * 20, MESSAGE="late"), Entry(1.0, "base", "error", "late")),
        (journal(__REALTIME_TIMESTAMP="9" * 5000), Entry(1700000000.12, "base", "warning", "low")),
        (journal(_SYSTEMD_UNIT="ssh.service"), None),
        ("-- No entries --", None),
        ("[1]", None),
    ],
)
def test_a_line_of_the_journal(line: str, entry: Entry | None) -> None:
    assert journal_entry(line, 1.0) == entry


def test_a_line_of_a_container() -> None:
    stamp = "2023-11-14T22:13:20.125000000Z"
    assert container_entry(f"{stamp} {OWN}", "base", 1.0) == Entry(1700000000.12, "base", "warning", "low")
    assert container_entry(f"{stamp} Segmentation fault", "base", 1.0).level == "error"
    dead = "Error response from daemon: No such container: ab12"
    assert container_entry(dead, "base", 1.0) == Entry(1.0, "base", "error", dead)
    listing = 'ab12\tbase\tgiraff:robot "python"\ncd34\tdb\tpostgres "postgres"\nef56\tweb\tsha256:1 "giraff"\n'
    assert [*containers_in(listing)] == [("ab12", "base"), ("ef56", "web")]


@pytest.mark.parametrize(
    ("word", "before_now"),
    [("90s", 90.0), ("10min", 600.0), ("10m", 600.0), ("1.5h", 5400.0), ("14:30", 900.0), ("14:50", 86100.0)],
)
def test_since_when(word: str, before_now: float) -> None:
    assert since_moment(word, NOW) == pytest.approx(NOW - before_now)
    assert since_moment("2026-05-31T14:40", NOW) == pytest.approx(NOW - 300.0)


def entry(at: float, service: str = "base") -> Entry:
    return Entry(at, service, "info", "here")


def test_entries_come_in_order_of_time_and_a_source_that_hangs_holds_up_the_others_for_a_while_only() -> None:
    merge = Merge(patience=5.0)
    for source in ("journal", "docker", "hangs"):
        merge.open(source, 0.0)
    merge.add("journal", [entry(1.0), entry(4.0)], 1.0)
    merge.add("docker", [entry(2.0), entry(3.0)], 1.0)
    assert merge.pop_due(4.9) == [], "the one that hangs may yet have an older one"
    assert [each.time for each in merge.pop_due(5.0)] == [1.0, 2.0, 3.0], "docker may yet have one before the journal's"
    assert merge.is_overdue("hangs", 5.0)
    assert not merge.is_overdue("docker", 5.0)
    merge.end("docker")
    assert [each.time for each in merge.pop_due(5.0)] == [4.0]
    merge.end("journal")
    merge.end("hangs")
    assert merge.pop_due(5.0) == []


def test_an_entry_cannot_steer_the_terminal_and_keeps_its_lines_together() -> None:
    hostile = Entry(NOW, "web\x1b[2J", "error", "\x1b]0;x\x07bad\nTraceback\r\n")
    plain = "2026-05-31 14:45:00.000 web?[2J      error    ?]0;x?bad\n    Traceback?"
    assert line_of(hostile, colours=False) == plain
    assert line_of(hostile, colours=True).replace("\x1b[31merror   \x1b[0m", "error   ") == plain
    assert "\x1b" not in json_of(hostile)
    assert msgspec.json.decode(json_of(hostile))["message"] == hostile.words


def test_a_log_that_grows_is_read_on_and_its_last_line_is_told_when_it_ends(tmp_path: Path) -> None:
    path = tmp_path / "base.log"
    path.write_text("\0" * 70_000 + "".join(f"line {number}\n" for number in range(20)) + "to")
    os.utime(path, (7.0, 7.0))
    log = LogFile(path, follow=True, last=10)
    assert [each.words for each in log.read()] == [f"line {number}" for number in range(10, 20)]
    assert (log.read(), log.has_ended) == ([], False)
    with path.open("a") as writer:
        writer.write(f"rn\n{OWN}\nand its tail")
    assert [(each.words, each.level) for each in log.read()] == [("torn", "error"), ("low", "warning")]
    path.unlink()
    assert log.read() == [Entry(1700000000.12, "base", "error", "and its tail")]
    assert log.has_ended
    log.close()


def test_a_link_is_left_out_and_a_pipe_holds_nothing_up(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    folder = tmp_path / "giraff-run-x"
    folder.mkdir()
    (folder / "base.log").write_text("own\n")
    (tmp_path / "other").write_text("another's\n")
    (folder / "web.log").symlink_to(tmp_path / "other")
    os.mkfifo(folder / "guard.log")
    for path in (folder / "base.log", folder / "guard.log", folder):
        os.utime(path, (7.0, 7.0))
    os.utime(folder / "web.log", (9.0, 9.0), follow_symlinks=False)
    streams, _ = runs(Wanted((), follow=False, since=None))
    words = [entry.words for stream in streams for entry in stream.read()]
    for stream in streams:
        stream.close()
    assert words == ["own"]
    assert [stream.ended for stream in streams if isinstance(stream, LogFile)] == [9.0, 9.0]


def test_a_run_that_ended_is_told_with_its_time_and_on_another_day_with_the_date() -> None:
    assert run_text("run", NOW - 600.0, NOW).endswith("the run in run that ended at 14:35")
    assert run_text("run", NOW - 86400.0, NOW).endswith("that ended on 2026-05-30 at 14:45")
