"""The project's images, built as a technician builds them, on stand-ins for what cannot be pulled. They are kept."""

from __future__ import annotations

import hashlib
import os
import shutil
import tempfile
from collections.abc import Iterable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Final

from tests.hosts.clone import clone, write_env
from tests.hosts.machine import BIN, Machine, run
from tests.rules.repository import ROOT

KEPT: Final = ROOT / "build" / "hosts"
CURRENT_COMPOSE: Final = KEPT / "compose"
"""As `prepare` gets it."""
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
_AT_ONCE: Final = 2
"""Builds: half of one is waiting for packages."""


def images(kinds: Iterable[str]) -> dict[str, Path]:
    """An archive of each image, built now unless one of these very sources is kept."""
    with tempfile.TemporaryDirectory(prefix="giraff-clone-") as folder:
        place = Path(folder) / "clone"
        clone(place)
        mark = _fingerprint(place)
        archives = {kind: KEPT / f"giraff-{kind}-{mark}.tar" for kind in kinds}
        wanted = [kind for kind, archive in archives.items() if not archive.is_file()]
        if wanted:
            _build(place, {kind: archives[kind] for kind in wanted})
    return archives


def _build(place: Path, archives: dict[str, Path]) -> None:
    builder = Machine("builder", KEPT / "builder", own_network=False)
    builder.power_on()
    try:
        builder.start_docker()
        builder.wait_for_docker()
        python = _stand_in(builder)
        tools = _stand_in(builder, "make", "gcc", "libc6-dev") if "sim" in archives else python
        stand_ins = {"BASE_IMAGE": python, "BUILD_IMAGE": python, "TOOLS_IMAGE": tools, "BUILD_NETWORK": "host"}

        def build(kind: str) -> None:
            own = place.with_name(kind)
            shutil.copytree(place, own)
            write_env(own, _HOST.get(kind, kind), {}, stand_ins)
            builder.compose(own, "build", _SERVICE[kind], within=_BUILD_WITHIN)
            for old in KEPT.glob(f"giraff-{kind}-*"):
                old.unlink()
            fresh = archives[kind].with_suffix(".new")
            builder.docker("save", "--output", str(fresh), f"giraff:{kind}")
            fresh.replace(archives[kind])

        with ThreadPoolExecutor(_AT_ONCE) as pool:
            list(pool.map(build, archives))
        builder.docker("image", "prune", "--force")
    finally:
        builder.power_off()


def _stand_in(builder: Machine, *packages: str) -> str:
    """Make the image unless the one of these very packages is kept; its name."""
    made_of = _STAND_IN.read_text() + " ".join(packages) + run(["dpkg-query", "--show"])
    name = f"giraff-stand-in:{hashlib.sha256(made_of.encode()).hexdigest()[:16]}"
    if not builder.docker("images", "--quiet", name).strip():
        command = [str(_STAND_IN), name, *packages]
        run(command, within=300.0, env=os.environ | {"PATH": BIN, "DOCKER_HOST": builder.socket})
    return name


def _fingerprint(place: Path) -> str:
    digest = hashlib.sha256()
    for top in _MADE_OF:
        path = place / top
        for file in sorted(path.rglob("*")) if path.is_dir() else [path]:
            if file.is_file():
                digest.update(f"{file.relative_to(place)}\0{file.stat().st_mode}\0".encode())
                digest.update(hashlib.sha256(file.read_bytes()).digest())
    return digest.hexdigest()[:16]
