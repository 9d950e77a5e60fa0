"""`giraff logs` as a process, with stand-ins for journalctl and docker, and a log as `giraff run` leaves it."""

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.support.waiting import wait

PATIENCE = 60.0
JOURNAL = """#!/bin/sh
echo $$ >>"$HERE/pids"
test -z "$DENIED" || { echo "No journal files were opened due to insufficient permissions." >&2; exit 1; }
case "$*" in *--lines=1) test -z "$MEET" || cat "$HERE/meet" ;; *--unit=giraff@base.service*) ;; *) exit 0 ;; esac
cat "$HERE/journal"
case "$*" in *--follow*) exec sleep 600 ;; esac
"""
DOCKER = """#!/bin/sh
echo $$ >>"$HERE/pids"
test -z "$DENIED" || { echo "permission denied while trying to connect to the Docker daemon socket" >&2; exit 1; }
case "$1" in
    ps)
        test -z "$MEET" || echo >"$HERE/meet"
        printf 'ab12\\tguard\\tgiraff:robot "python -m giraff_node guard"\\n'
        ;;
    logs)
        echo "a live view"
        cat "$HERE/container" >&2
        case "$*" in *--follow*) exec sleep 600 ;; esac
        ;;
esac
"""
OF_THE_JOURNAL = (
    '{"__REALTIME_TIMESTAMP":"1700000002000000","_TRANSPORT":"stdout","_SYSTEMD_UNIT":"giraff@base.service",'
    '"MESSAGE":"of the journal"}\n'
)
OF_DOCKER = (
    '2023-11-14T22:13:21.500Z {"time":"2023-11-14T22:13:21.000Z","level":"info","service":"guard",'
    '"message":"of Docker"}\n'
)
OF_A_RUN = '{{"time":"2023-11-14T22:13:{:02}.000Z","level":"warning","service":"web","message":"of a run, {}"}}\n'


class Host:
    """A host with an own PATH and folder for temporary files."""

    def __init__(self, folder: Path) -> None:
        for name, text in {"journalctl": JOURNAL, "docker": DOCKER}.items():
            (folder / name).write_text(text)
            (folder / name).chmod(0o755)
        (folder / "journal").write_text(OF_THE_JOURNAL)
        (folder / "container").write_text(OF_DOCKER)
        os.mkfifo(folder / "meet")  # with MEET, journalctl and docker answer once both have been asked
        self.folder = folder
        self.log = folder / "giraff-run-x" / "web.log"
        self.log.parent.mkdir()
        self.log.write_text(OF_A_RUN.format(21, 1) + OF_A_RUN.format(23, 2))
        for path in (self.log, self.log.parent):
            os.utime(path, (1700000004.0, 1700000004.0))
        ended = "ended on 2023-11-14 at 22:13"
        self.says = f"giraff logs: no run goes on; shown is the run in {self.log.parent} that {ended}\n"
        self.environment = {
            **os.environ,
            "PATH": f"{folder}:/usr/bin:/bin",
            "HERE": str(folder),
            "TMPDIR": str(folder),
            "TZ": "UTC",
        }

    def start(self, *words: str, **environment: str) -> subprocess.Popen[str]:
        return subprocess.Popen(
            [str(Path(sys.executable).with_name("giraff")), "logs", *words],
            env=self.environment | environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )

    def run(self, *words: str, **environment: str) -> tuple[int, str, str]:
        with self.start(*words, **environment) as process:
            out, err = process.communicate(timeout=PATIENCE)
            return process.returncode, out, err

    def is_quiet(self) -> bool:
        """None of the stand-ins runs any more."""
        return not any(Path(f"/proc/{pid}").exists() for pid in (self.folder / "pids").read_text().split())


@pytest.fixture
def host(tmp_path: Path) -> Iterator[Host]:
    made = Host(tmp_path)
    yield made
    wait(made.is_quiet, PATIENCE, what="the end of what it has started")


def test_the_words_of_all_sources_come_in_one_order(host: Host) -> None:
    told = (
        "2023-11-14 22:13:21.000 guard        info     of Docker\n"
        "2023-11-14 22:13:21.000 web          warning  of a run, 1\n"
        "2023-11-14 22:13:22.000 base         error    of the journal\n"
        "2023-11-14 22:13:23.000 web          warning  of a run, 2\n"
    )
    assert host.run(MEET="yes") == (0, told, host.says), "they are asked at once: one that hangs takes no other's time"


def test_where_nothing_may_be_read_it_says_what_to_do(host: Host) -> None:
    host.log.unlink()
    code, out, err = host.run(DENIED="yes")
    assert (code, out) == (2, "")
    assert (
        "may not read the journal; add it to the group systemd-journal (sudo usermod -aG systemd-journal $USER)" in err
    )
    assert "may not ask Docker; add it to the group docker" in err


def test_it_goes_on_with_what_comes_and_ctrl_c_is_quiet(host: Host) -> None:
    with host.start("--follow", "--level", "warning", "--json") as process:
        assert process.stdout is not None
        told = [process.stdout.readline() for _ in range(3)]
        assert sorted(line.partition('"message":')[2] for line in told) == [
            '"of a run, 1"}\n',
            '"of a run, 2"}\n',
            '"of the journal"}\n',
        ]
        with host.log.open("a") as log:
            log.write(OF_A_RUN.format(24, "while it is watched"))
        assert "while it is watched" in process.stdout.readline()
        process.send_signal(signal.SIGINT)
        assert process.communicate(timeout=PATIENCE) == ("", host.says)
        assert process.returncode == 0


def test_it_ends_when_its_reader_goes(host: Host) -> None:
    with host.start("-f") as process:
        assert process.stdout is not None
        process.stdout.readline()
        process.stdout.close()
        assert process.stderr is not None
        assert process.stderr.read() == host.says
        assert process.wait(PATIENCE) == 0
