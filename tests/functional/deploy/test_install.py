"""`make install`: whole or not at all, again without harm, and never over what somebody has changed."""

import os
import shutil
import subprocess
import tempfile
from pathlib import Path

import pytest

from giraff_schemas.services import ROLES
from giraff_sim.board import ROOT
from giraff_tools.network.ports import free_port
from tests.functional.deploy.installing import TRUE_PYTHON, Tree
from tests.support.waiting import wait

CONFIGURATION = "/etc/giraff/robot.toml"
RULES = "/etc/udev/rules.d/99-giraff.rules"


@pytest.fixture
def tree(tmp_path: Path) -> Tree:
    return Tree(tmp_path)


@pytest.mark.timeout(600)  # 10 s of work, for a machine that does nothing else
def test_a_service_of_the_installed_tree_runs_and_is_well(tree: Tree, tmp_path: Path) -> None:
    code, words = tree.install(PYTHON=str(TRUE_PYTHON), ROLE="robot")
    assert code == 0, words
    made = tree.installed("/opt/giraff")
    named = [path for path in (*made.glob("bin/*"), made / "pyvenv.cfg") if str(tree.target) in readable(path)]
    assert named == []  # it will be elsewhere
    assert not (made / "bin" / "giraff").exists()
    assert list(made.glob("lib/python3*/site-packages/giraff_base/__pycache__/service.*.pyc"))
    typed = {path.parent.name for path in made.glob("lib/python3*/site-packages/giraff_*/py.typed")}
    assert typed == {path.parent.name for root in ("schemas", "services") for path in ROOT.glob(f"{root}/*/py.typed")}
    assert "giraff_client" in typed
    wants = tree.installed("/etc/systemd/system/giraff.target.wants")
    assert {path.name for path in wants.iterdir()} == {f"giraff@{service}.service" for service in ROLES["robot"]}
    environment = {
        "GIRAFF_CONFIG": str(tree.installed(CONFIGURATION)),
        "GIRAFF_NETWORK_LOCAL": "true",
        "GIRAFF_NETWORK_RENDEZVOUS": f"127.0.0.1:{free_port()}",
        "RUNTIME_DIRECTORY": str(tmp_path),
    }
    python = [str(made / "bin" / "python"), "-I"]
    command = [*python, "-m", "giraff_node", "odometry"]
    with (tmp_path / "log").open("wb") as log:
        service = subprocess.Popen(command, env=environment, cwd=tmp_path, stderr=log)
    try:

        def is_there() -> bool:
            assert service.poll() is None, (tmp_path / "log").read_text()
            return (tmp_path / "odometry.sock").exists()

        wait(is_there, 60.0, what="its start")
        check = [*python, "-m", "giraff_health", "odometry"]
        asked = subprocess.run(check, env=environment, capture_output=True, text=True, check=False)
        assert asked.returncode == 0, asked.stdout
    finally:
        service.kill()
        service.wait()


def readable(path: Path) -> str:
    return path.read_text(encoding="utf-8", errors="replace") if path.is_file() and not path.is_symlink() else ""


def test_a_second_run_changes_nothing(tree: Tree) -> None:
    assert tree.install()[0] == 0
    before = times(tree)
    code, words = tree.install()
    assert code == 0
    assert "is up to date" in words
    assert "robot.toml, as it comes" in words
    changed = {path for path, at in times(tree).items() if before.get(path) != at}
    assert {path.name for path in changed} <= {
        *(".shipped", "giraff@.service", "giraff-board@.service", "behind.conf", "giraff.target"),
        "giraff.conf",  # of sysusers.d and tmpfiles.d
    }


def times(tree: Tree) -> dict[Path, int]:
    return {path: path.lstat().st_mtime_ns for path in tree.target.rglob("*") if path.is_file()}


def test_what_somebody_has_changed_is_kept_and_the_new_one_lies_beside_it(tree: Tree) -> None:
    tree.install()
    paths = (CONFIGURATION, RULES, "/etc/giraff/giraff.env")
    for path in paths:
        tree.installed(path).write_text("mine\n")
    for _ in range(2):
        code, words = tree.install()
        assert code == 0
        for path in paths:
            mine = tree.installed(path)
            assert f"{path}, which you have changed" in words
            assert mine.read_text() == "mine\n"
            assert mine.with_name(f"{mine.name}.new").exists()


def test_what_was_there_before_the_first_installation_is_kept(tree: Tree) -> None:
    mine = tree.installed(CONFIGURATION)
    mine.parent.mkdir(parents=True)
    mine.write_text("mine\n")
    assert tree.install()[0] == 0
    assert mine.read_text() == "mine\n"


def test_what_nobody_has_changed_is_renewed(tree: Tree) -> None:
    tree.install()
    with (tree.source / "deploy" / "robot.toml").open("a") as newer:
        newer.write("# of the next version\n")
    code, words = tree.install()
    assert code == 0
    assert f"wrote     {CONFIGURATION}" in words
    assert tree.installed(CONFIGURATION).read_text().endswith("# of the next version\n")
    # Having been mine once does not make it mine for ever.
    tree.installed(CONFIGURATION).write_text("mine\n")
    tree.install()
    shutil.copy(tree.source / "deploy" / "robot.toml", tree.installed(CONFIGURATION))
    tree.install()
    assert not tree.installed(f"{CONFIGURATION}.new").exists()


def test_a_changed_source_makes_it_anew(tree: Tree) -> None:
    tree.install()
    with (tree.source / "services" / "giraff_base" / "policy.py").open("a") as source:
        source.write("# changed\n")
    assert "making" in tree.install()[1]


def test_what_fails_halfway_leaves_the_old_one(tree: Tree) -> None:
    tree.install()
    (tree.installed("/opt/giraff") / "old").touch()
    with (tree.source / "requirements" / "robot.lock").open("a") as lock:
        lock.write("# changed\n")
    code, words = tree.install(PIP_FAILS="yes")
    assert code == 1
    assert "what was there before still is" in words
    assert (tree.installed("/opt/giraff") / "old").exists()
    assert tree.install()[0] == 0
    assert not (tree.installed("/opt/giraff") / "old").exists()
    assert [path.name for path in tree.installed("/opt").iterdir()] == ["giraff"]


@pytest.mark.parametrize("role", ROLES)
def test_a_role_enables_its_services_and_the_target(tree: Tree, role: str) -> None:
    code, words = tree.install(ROLE=role)
    assert code == 0, words
    enabled = {path.name for path in tree.installed("/etc/systemd/system").glob("giraff.target.wants/*")}
    assert enabled == {f"giraff@{service}.service" for service in ROLES[role]}
    assert {path.name for path in tree.installed("/etc/systemd/system").glob("multi-user.target.wants/*")} == (
        {"giraff.target"} if role else set()  # and no rules of a firewall, which are only offered
    )
    assert tree.installed("/etc/giraff/giraff.nft").exists() is (role == "robot")
    assert ("systemctl enable giraff-firewall" in words) is (role == "robot")


def test_a_base_board_that_is_a_process_is_enabled_where_the_robot_file_names_it(tree: Tree) -> None:
    for name in ("roboclaw", "base.elf"):
        (program := tree.source / "build" / "firmware" / name).parent.mkdir(parents=True, exist_ok=True)
        program.write_text("built\n")
    for file, enabled, words in (
        ("robots/roboclaw.toml", ["giraff-board@roboclaw.service"], ""),
        ("udev/99-giraff.rules", ["giraff-board@roboclaw.service"], "base refuses /etc/giraff/robot.toml"),
        ("robots/ros_arduino_bridge.toml", [], "giraff-board@ros_arduino_bridge has no program: make -C firmware"),
    ):
        tree.installed(CONFIGURATION).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(tree.source / "deploy" / file, tree.installed(CONFIGURATION))
        code, said = tree.install(ROLE="robot")
        assert (code, words in said) == (0, True), said
        wanted = tree.installed("/etc/systemd/system/giraff.target.wants")
        assert [path.name for path in wanted.glob("giraff-board@*")] == enabled, file
    assert [path.name for path in tree.installed("/opt/giraff/boards").iterdir()] == ["roboclaw"]


def test_a_laptop_has_the_command_line_and_so_has_a_robot_that_asks_for_it(tree: Tree) -> None:
    command = tree.installed("/opt/giraff/bin/giraff")
    for role, lock, there in (("robot", "", False), ("laptop", "", True), ("robot", "laptop", True)):
        code, words = tree.install(ROLE=role, LOCK=lock)
        assert code == 0, words
        assert command.exists() is there


def test_umask_and_other_users(tree: Tree) -> None:
    before = os.umask(0o077)
    try:
        assert tree.install()[0] == 0
    finally:
        os.umask(before)
    closed = [path for path in tree.target.rglob("*") if not path.is_symlink() and not path.stat().st_mode & 0o004]
    assert closed == []


@pytest.mark.parametrize(
    ("variables", "words"),
    [
        ({"ROLE": "desk"}, "there are robot and laptop"),
        ({"LOCK": "toaster"}, "no requirements/toaster.lock"),
        ({"DESTDIR": "below"}, "an absolute path"),
        ({"DESTDIR": "/with space"}, "without spaces"),
        ({"PYTHON": "/nowhere/python3"}, "apt-get install python3"),
        ({"PYTHON": "/bin/false"}, "older than 3.11"),
    ],
)
def test_what_cannot_work_is_refused_with_the_way_out(tree: Tree, variables: dict[str, str], words: str) -> None:
    code, said = tree.install(**variables)
    assert code == 1
    assert words in said
    assert not tree.target.exists()


def test_a_python_that_makes_no_environments_is_refused(tree: Tree) -> None:
    python = tree.seeming_python
    python.write_text("#!/bin/sh\ncase $2 in *ensurepip*) exit 1 ;; esac\n")
    code, said = tree.install()
    assert code == 1
    assert "python3-venv" in said


def test_without_root_it_is_refused() -> None:
    with tempfile.TemporaryDirectory() as name:  # where everybody may look, unlike pytest's own
        script = Path(name) / "scripts" / "install"
        script.parent.mkdir()
        shutil.copy(ROOT / "scripts" / "install", script)
        Path(name).chmod(0o755)
        run = subprocess.run(
            [script],
            env={"PATH": os.environ["PATH"]},
            capture_output=True,
            text=True,
            check=False,
            cwd="/",
            user=65534 if os.geteuid() == 0 else None,
        )
    assert run.returncode == 1
    assert "sudo make install" in run.stderr
