"""A computer of the lab: namespaces of its own and a Docker daemon in them. Whatever runs on it ends with its power."""

import contextlib
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any, Final

from giraff_cli.run import launch

BIN: Final = "/usr/sbin:/usr/bin:/sbin:/bin"
"""Debian's own programs, whatever else this machine has in front of them."""
COMPOSE: Final = "/usr/bin/docker-compose"
_CGROUPS: Final = Path("/sys/fs/cgroup")
_TCP: Final = "net.ipv4.tcp_congestion_control=reno"
_CGROUP: Final = "giraff-hosts"
_URGENT: Final = 10240
"""Share of the processor for a machine. A single process has 1024, and a machine runs several."""
_LATER: Final = 64
"""Share for work that nobody waits for. A process at nice 19 has 15."""
_BOOT_WITHIN: Final = 60.0  # s


class LabError(Exception):
    """The lab does not work; the message says what did not and what it said."""


def run(command: list[str], within: float = 60.0, **options: Any) -> str:
    """Run a program of this machine; what it printed. LabError where it fails."""
    options.setdefault("env", os.environ | {"PATH": BIN})
    done: subprocess.CompletedProcess[str] = subprocess.run(
        command, check=False, capture_output=True, text=True, timeout=within, **options
    )
    if done.returncode != 0:
        raise LabError(f"{' '.join(command)}: exit code {done.returncode}: {done.stdout[-2000:]}{done.stderr[-4000:]}")
    return done.stdout


def later(command: list[str]) -> list[str]:
    """Return the command line of a program that slows down no other. It must be started in a session of its own.

    The kernel weighs sessions against each other before it asks how nice their processes are.
    """
    return ["sh", "-c", 'echo 19 >/proc/self/autogroup; exec nice -n 19 "$@"', "sh", *command]


class Machine:
    """Off, once made. `directory` is its disk: the daemon's files stay there while it is off.

    `is_urgent`: False for a machine that must not slow down the others.
    """

    def __init__(self, name: str, directory: Path, *, own_network: bool = True, is_urgent: bool = True) -> None:
        self.name = name
        self.directory = directory
        directory.mkdir(parents=True, exist_ok=True)
        self.socket = f"unix://{directory}/docker.sock"
        self._own_network = own_network
        self._is_urgent = is_urgent
        self._cgroup = _CGROUP if is_urgent else f"{_CGROUP}-later"
        self._supply: subprocess.Popen[bytes] | None = None
        self._first = 0
        self._daemon: subprocess.Popen[bytes] | None = None

    @property
    def pid(self) -> int:
        """Of its first process, by which its namespaces are found."""
        if not self.is_on:
            raise LabError(f"{self.name} is off")
        return self._first

    @property
    def is_on(self) -> bool:
        return self._first != 0

    def power_on(self) -> None:
        """Its first process; nothing is plugged in, and no daemon runs."""
        # Its first process takes all others along when it ends; it ends with `unshare`, and that with the test, however
        # that ends. Then the namespaces are nobody's, and with them go mounts, links and routes.
        spaces = ["--mount", "--propagation", "slave", "--pid", "--fork", "--kill-child", "--mount-proc", "--uts"]
        spaces += ["--net"] if self._own_network else []
        # What a reboot forgets is a tmpfs; and this machine's own congestion control may be another than Debian's.
        boot = f"mount -t tmpfs tmpfs /run && hostname {self.name} && sysctl --quiet --write {_TCP} && "
        boot += "exec docker-init -- sleep infinity"
        launcher = [sys.executable, "-I", "-S", str(launch.__file__), str(os.getpid())]
        self._supply = subprocess.Popen(
            [*launcher, "/usr/bin/unshare", *spaces, "sh", "-c", boot],
            env=os.environ | {"PATH": BIN},
            stdin=subprocess.DEVNULL,
            start_new_session=True,  # Ctrl-C in the terminal is for the test, which then ends this in its order
        )
        children = Path(f"/proc/{self._supply.pid}/task/{self._supply.pid}/children")
        deadline = time.monotonic() + _BOOT_WITHIN
        while True:
            with contextlib.suppress(OSError):
                if (found := children.read_text(encoding="utf-8").split()) and self._has_booted(int(found[0])):
                    self._first = int(found[0])
                    return
            if self._supply.poll() is not None or time.monotonic() > deadline:
                raise LabError(f"{self.name}: does not boot: {' '.join(spaces)} needs root")
            time.sleep(0.01)

    def start_docker(self) -> None:
        """Start the daemon, as a boot does. `wait_for_docker` waits for it."""
        data = self.directory / "docker"
        command = ["dockerd", "--data-root", str(data), "-H", self.socket, "--log-level", "warn"]
        # Containers take the host's network, and the host has no other.
        command += ["--bridge=none", "--iptables=false", "--ip6tables=false", "--ip-forward=false"]
        command += ["--cgroup-parent", f"/{self._cgroup}/{self.name}"]
        for group in (self._cgroup, f"{self._cgroup}/{self.name}"):
            _give_weight(group, _URGENT if self._is_urgent else _LATER)
        if not self._is_urgent:
            command = later(command)
        with (self.directory / "dockerd.log").open("ab") as log:
            self._daemon = self.start(command, stdin=subprocess.DEVNULL, stdout=log, stderr=log)

    def wait_for_docker(self) -> None:
        deadline = time.monotonic() + _BOOT_WITHIN
        while True:
            with contextlib.suppress(LabError):
                self.docker("version")
                return
            if time.monotonic() > deadline or (self._daemon is not None and self._daemon.poll() is not None):
                raise LabError(f"{self.name}: no Docker: {(self.directory / 'dockerd.log').read_text()[-2000:]}")
            time.sleep(0.05)

    def power_off(self) -> None:
        """As when the plug is pulled: nothing ends, everything is gone. Already off is fine."""
        if self._supply is None:
            return
        self._supply.kill()
        self._supply.wait()
        deadline = time.monotonic() + _BOOT_WITHIN
        while self._first and not _has_ended(self._first):
            if time.monotonic() > deadline:
                raise LabError(f"{self.name}: process {self._first} does not end")
            time.sleep(0.01)
        if self._daemon is not None:
            self._daemon.wait()
        self._supply = self._daemon = None
        self._first = 0
        _remove_cgroups(self._cgroup, self.name)

    def start(self, command: list[str], **options: Any) -> subprocess.Popen[Any]:
        """Start a program on it. It ends with the machine's power."""
        # Its /run is its own, its /tmp is not: at sockets there it would meet the other machines.
        options.setdefault("env", os.environ | {"PATH": BIN, "XDG_RUNTIME_DIR": "/run"})
        return subprocess.Popen(self.inside(command), start_new_session=True, **options)

    def inside(self, command: list[str]) -> list[str]:
        """Return the command line that runs a program on it."""
        spaces = ["--mount", "--pid", "--uts", *(["--net"] if self._own_network else [])]
        return ["/usr/bin/nsenter", "--target", str(self.pid), *spaces, "--", *command]

    def docker(self, *words: str, within: float = 60.0, given: str = "") -> str:
        return run(["docker", "--host", self.socket, *words], within, input=given)

    def compose(self, place: Path, *words: str, within: float = 120.0, program: str | Path = COMPOSE) -> str:
        """`docker-compose` as it is typed in a clone at `place`, where no variable is set."""
        environment = {"HOME": os.environ.get("HOME", "/"), "PATH": BIN, "DOCKER_HOST": self.socket}
        return run([str(program), "--ansi", "never", *words], within, cwd=place, env=environment)

    def _has_booted(self, first: int) -> bool:
        return Path(f"/proc/{first}/comm").read_text(encoding="utf-8").strip() == "docker-init"


def let_first(pid: int) -> None:
    """Let a process of one thread run as soon as it wants to: boards and cables share no processor with anybody."""
    os.sched_setscheduler(pid, os.SCHED_RR, os.sched_param(1))


def kill(process: subprocess.Popen[bytes]) -> None:
    """End a program that `Machine.start` has started: it is a child of what was started, and in its group."""
    if process.poll() is None:  # else its number may be another's by now
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()


def _has_ended(pid: int) -> bool:
    """Whether a process, and all of which it was the first, has ended. Who buries it may take seconds until he does."""
    try:
        state = Path(f"/proc/{pid}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()[0]
    except (FileNotFoundError, ProcessLookupError):
        return True
    return state == "Z"


def _give_weight(group: str, shares: int) -> None:
    """Weigh a group of processes against others.

    On a host of its own each container stands beside the Docker daemon. Here a machine's are one group, and all
    machines' are one, which would share what a single process of this machine gets.
    """
    controller = _CGROUPS / "cpu"
    if controller.is_dir():  # cgroups 1; in 2 a group's weight is counted against groups, not against processes
        place = controller / group
        place.mkdir(exist_ok=True)
        (place / "cpu.shares").write_text(str(shares))


def _remove_cgroups(group: str, name: str) -> None:
    """Remove what a killed daemon leaves. A cgroup is empty a moment after its last process."""
    deadline = time.monotonic() + _BOOT_WITHIN
    for root in (_CGROUPS, *_CGROUPS.glob("*/")):
        ours = root / group / name
        for path in (*sorted(ours.rglob("*/"), reverse=True), ours, root / group):
            while path.is_dir():
                try:
                    path.rmdir()
                except OSError as error:
                    if path.name == group:
                        break  # other machines are in it
                    if time.monotonic() > deadline:
                        raise LabError(f"{path}: {error}") from error
                    time.sleep(0.01)
