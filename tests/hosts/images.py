"""The project's images, built as a technician builds them, on stand-ins for what cannot be pulled. They are kept."""

import fcntl
import hashlib
import json
import os
import shutil
import sys
import tempfile
from collections.abc import Iterable
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import ExitStack
from pathlib import Path
from typing import Any, Final

from tests.hosts.clone import clone, write_env
from tests.hosts.machine import BIN, LabError, Machine, later, run
from tests.rules.repository import ROOT

KEPT: Final = ROOT / "build" / "hosts"
CURRENT_COMPOSE: Final = KEPT / "compose"
"""As `prepare` gets it."""
_WHEELS: Final = Path.home() / ".cache" / "giraff" / "wheels"
"""They outlive a clone: whatever is taken from here has one of its lock's hashes."""
_STAND_IN: Final = Path(__file__).with_name("stand_in")
_SERVICE: Final = {"robot": "base", "laptop": "joystick", "sim": "sim", "recorder": "recorder", "web": "web"}
"""Image -> a compose service that runs in it."""
_HOST: Final = {"recorder": "robot", "web": "robot"}
"""Image -> the kind of host that builds it, where that is another word."""
_MADE_OF: Final = (
    *("Dockerfile", ".dockerignore", "docker-compose.yml", "pyproject.toml", "requirements"),
    *("schemas", "services", "firmware", "deploy/robot.toml", "deploy/worlds"),
)
_BUILD_WITHIN: Final = 600.0  # s
_WITH_WHEELS: Final = """
FROM {python}
COPY . /wheels
ENV PIP_NO_INDEX=1 PIP_FIND_LINKS=/wheels
"""


class Images:
    """Builds images while its caller does something else, and gives them to machines. One at a time on this machine."""

    def __init__(self) -> None:
        self._end = ExitStack()
        self._builder = Machine("builder", KEPT / "builder", own_network=False, is_urgent=False)
        self._disk = self._builder.directory / "docker"
        self._pool = ThreadPoolExecutor()
        self._work: Future[None] | None = None
        self._is_locked = False

    def build(self, kinds: Iterable[str]) -> None:
        """Begin to build those of them that are not kept of these very sources. `give` waits for their end."""
        self._wait()
        self._lock()
        place = Path(self._end.enter_context(tempfile.TemporaryDirectory(prefix="giraff-clone-"))) / "clone"
        clone(place)
        made_of = _fingerprint(place)
        marks = {kind: self._builder.directory / f"built-{kind}" for kind in sorted(set(kinds))}
        missing = {kind: mark for kind, mark in marks.items() if not mark.is_file() or mark.read_text() != made_of}
        if missing:
            self._builder.power_on()
            self._builder.start_docker()
            self._work = self._pool.submit(self._build, place, missing, made_of)

    def give(self, machine: Machine, kinds: Iterable[str]) -> None:
        """Let the Docker of a machine, which does not run, have images that were built.

        It reads their layers where the builder has them: of a layer, no Docker ever writes anything.
        """
        self._wait()
        own = machine.directory / "docker"
        shutil.copytree(
            self._disk / "image", own / "image", ignore=shutil.ignore_patterns("mounts"), dirs_exist_ok=True
        )
        (own / "overlay2" / "l").mkdir(parents=True, exist_ok=True)
        for layer in (*self._disk.glob("overlay2/*"), *self._disk.glob("overlay2/l/*")):
            there = own / layer.relative_to(self._disk)
            if not there.is_symlink() and not there.exists():
                there.symlink_to(layer.readlink() if layer.is_symlink() else layer)
        names = own / "image" / "overlay2" / "repositories.json"
        built = json.loads(names.read_text())["Repositories"]["giraff"]
        given = {name: built[name] for name in (f"giraff:{kind}" for kind in kinds)}
        names.write_text(json.dumps({"Repositories": {"giraff": given}}))

    def close(self) -> None:
        """Whatever is being built ends, too."""
        self._builder.power_off()
        self._pool.shutdown(cancel_futures=True)
        self._end.close()

    def _lock(self) -> None:
        if self._is_locked:
            return
        KEPT.mkdir(parents=True, exist_ok=True)
        lock = self._end.enter_context((KEPT / "lock").open("w"))
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise LabError("another lab runs on this machine; wait for it") from None
        self._is_locked = True

    def _wait(self) -> None:
        if self._work is not None:
            self._work.result()
            self._work = None
            self._builder.power_off()

    def _build(self, place: Path, missing: dict[str, Path], made_of: str) -> None:
        self._builder.wait_for_docker()
        packages = ("make", "gcc", "libc6-dev") if "sim" in missing else ()
        tools = self._pool.submit(self._stand_in, *packages)
        locks = [f"requirements/{kind}.lock" for kind in missing]
        wheels = self._pool.submit(_wheels, place.with_name("wheels"), locks)
        python = self._stand_in()
        builds = f"{python}-wheels"
        dockerfile = _WITH_WHEELS.format(python=python)
        self._builder.docker("build", "--tag", builds, "--file", "-", str(wheels.result()), given=dockerfile)
        stand_ins = {
            "BASE_IMAGE": python,
            "BUILD_IMAGE": builds,
            "TOOLS_IMAGE": tools.result(),
            "BUILD_NETWORK": "none",
        }

        def build(kind: str) -> None:
            own = place.with_name(kind)
            shutil.copytree(place, own)
            write_env(own, _HOST.get(kind, kind), {}, stand_ins)
            self._builder.compose(own, "build", _SERVICE[kind], within=_BUILD_WITHIN)
            missing[kind].write_text(made_of)

        list(self._pool.map(build, missing))
        # What was installed lately the next build takes over; and removing it takes as long as half a build.
        self._builder.docker("image", "prune", "--force", "--filter", "until=1h")

    def _stand_in(self, *packages: str) -> str:
        """Make the image unless the one of these very packages is kept; its name."""
        made_of = _STAND_IN.read_text() + " ".join(packages) + run(["dpkg-query", "--show"])
        name = f"giraff-stand-in:{hashlib.sha256(made_of.encode()).hexdigest()[:16]}"
        if not self._builder.docker("images", "--quiet", name).strip():
            environment = os.environ | {"PATH": BIN, "DOCKER_HOST": self._builder.socket}
            _run_later([str(_STAND_IN), name, *packages], env=environment)
        return name


def _wheels(place: Path, locks: list[str]) -> Path:
    """Put the wheels that these locks name for this machine into a folder, from this machine where it has them all."""
    download = [sys.executable, "-m", "pip", "download", "--quiet", "--require-hashes", "--no-deps"]
    download += ["--only-binary", ":all:", *(f"--requirement={lock}" for lock in locks)]
    collect = [*download, "--no-index", "--find-links", str(_WHEELS), "--dest", str(place)]
    _WHEELS.mkdir(parents=True, exist_ok=True)
    try:
        _run_later(collect, cwd=ROOT)
    except LabError:
        _run_later([*download, "--dest", str(_WHEELS)], cwd=ROOT)
        _run_later(collect, cwd=ROOT)
    return place


def _run_later(command: list[str], **options: Any) -> None:
    run(later(command), _BUILD_WITHIN, start_new_session=True, **options)


def _fingerprint(place: Path) -> str:
    digest = hashlib.sha256()
    for top in _MADE_OF:
        path = place / top
        for file in sorted(path.rglob("*")) if path.is_dir() else [path]:
            if file.is_file():
                digest.update(f"{file.relative_to(place)}\0{file.stat().st_mode}\0".encode())
                digest.update(hashlib.sha256(file.read_bytes()).digest())
    return digest.hexdigest()
