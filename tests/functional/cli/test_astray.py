"""A stop that cannot know its way is tried all the same, and the command that it names reaches the robot for sure."""

import os
import re
import shlex
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest

from giraff_core.access import AccessConfig
from giraff_core.network import NetworkConfig
from giraff_node.network.session import close_session, open_session
from giraff_tools.network.ports import free_port
from tests.functional.cli.bases import ROBOT, Base, base
from tests.support.elsewhere import GIRAFF
from tests.support.secured_hosts import authority
from tests.unit.cli.typed import typed


@pytest.fixture
def stranger() -> Iterator[tuple[Base, str]]:
    """A robot of the same name, on a network that is not secured, and its address."""
    network = NetworkConfig(rendezvous=f"127.0.0.1:{free_port()}", local=True)
    staying = open_session(network, ROBOT, "door")
    with base(network) as robot:
        yield robot, network.rendezvous
    assert close_session(staying)


@pytest.fixture(scope="module")
def keys(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return authority(tmp_path_factory.mktemp("secured"))


@pytest.fixture
def robot(keys: Path) -> Iterator[tuple[Base, str]]:
    """The right one, on a secured network, and its rendezvous."""
    network = NetworkConfig(
        mode="secured",
        rendezvous=f"127.0.0.1:{free_port()}",
        keys=str(keys / "robot"),
        access=AccessConfig(robot=("robot",), viewers=("desk",)),
        local=True,
    )
    staying = open_session(network, ROBOT, "door")
    with base(network) as made:
        yield made, network.rendezvous
    assert close_session(staying)


@pytest.fixture
def environment(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> pytest.MonkeyPatch:
    """Of somebody who has no robot file yet."""
    monkeypatch.chdir(tmp_path)
    for name in list(os.environ):
        if name.startswith("GIRAFF_"):
            monkeypatch.delenv(name)
    monkeypatch.setenv("GIRAFF_NETWORK_LOCAL", "true")
    monkeypatch.setenv("PATH", f"{GIRAFF.parent}:{os.environ['PATH']}")
    return monkeypatch


def named_by(refusal: str) -> str:
    """The command that a refusal names."""
    [command] = re.findall(r"without the file: (.*?)(?:; |\n)", refusal)
    return str(command)


def as_typed(command: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(["sh", "-c", command], check=False, capture_output=True, text=True, timeout=100.0)


def typed_here(
    environment: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], command: str
) -> tuple[int, str, str]:
    """The same in this process, of a command that a shell would only split."""
    words = shlex.split(command)
    while words[0] != "giraff":
        word = words.pop(0)
        if word == "-u":
            environment.delenv(words.pop(0))
        elif "=" in word:
            environment.setenv(*word.split("=", 1))
        else:
            assert word == "env"
    return typed(environment, capsys, *words[1:], "--timeout", "60")


def test_without_a_fault_this_stranger_would_obey(
    stranger: tuple[Base, str], environment: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """So that the next test can fail."""
    obeys, address = stranger
    environment.setenv("GIRAFF_NETWORK_RENDEZVOUS", address)
    code, out, _ = typed(environment, capsys, "estop", "engage", "--robot", ROBOT, "--timeout", "60")
    assert code == 0
    assert "STOPPED" in out
    assert obeys.asked


def test_a_mistyped_mode_does_not_stop_a_stranger(
    stranger: tuple[Base, str], environment: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    spared, address = stranger
    environment.delenv("GIRAFF_NETWORK_LOCAL")  # which keeps it from any address
    environment.setenv("GIRAFF_NETWORK_MODE", "secure")
    code, out, err = typed(environment, capsys, "estop", "engage", "--robot", ROBOT, "--connect", address)
    assert (code, out, spared.asked) == (2, "", [])
    assert "NOTHING IS STOPPED" in err


@pytest.mark.parametrize(
    ("text", "variables"),
    [
        ("[robot]\nname = '{robot}'\n[network]\nrendezvous = '{address}'\nmode = 'lann'", {}),
        ("[robot]\nname = '{robot}'\n[network]\nrendezvous = '{address}'\nsite = 'home'\nrouter = '/'", {}),
        ("[robot]\nname = '{robot}'\n[network]\nrouter = 'x'", {"GIRAFF_NETWORK_RENDEZVOUS": "{address}"}),
        ("[robot", {"GIRAFF_NETWORK_RENDEZVOUS": "{address}", "GIRAFF_ROBOT_NAME": "{robot}"}),
        (
            "[robot]\nname = '{robot}'\n[network]\nrendezvous = '{address}'\n[guard]\nmode = 'lan'",
            {"GIRAFFE_NETWORK_MODE": "lan", "GIRAFF_BASE_MODE": "lan", "GIRAFF_GUARD_PRIORITIES": "{{"},
        ),
        (
            "[robot]\nname = '{robot}'\n[netwrok]\nmode = 'lan'",
            {"GIRAFF_NETWORK_RENDEZVOUS": "{address}", "GIRAFF_NETWROK_MODE": "lan", "GIRAFF_NETWORK_CONNECT": "[a"},
        ),
    ],
)
def test_the_command_that_it_names_stops_the_robot(
    text: str,
    variables: dict[str, str],
    tmp_path: Path,
    stranger: tuple[Base, str],
    environment: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """On a network that is not secured, with the broken file where it is looked for."""
    robot, address = stranger
    file = tmp_path / "deploy" / "robot.toml"
    file.parent.mkdir()
    file.write_text(text.format(robot=ROBOT, address=address))
    for name, value in variables.items():
        environment.setenv(name, value.format(robot=ROBOT, address=address))
    code, out, err = typed(environment, capsys, "estop", "engage", "--timeout", "0.3")
    assert (code, out) == (2, "")
    assert f"{ROBOT}: STOPPED" not in err
    code, out, complaint = typed_here(environment, capsys, named_by(err))
    assert (code, complaint) == (0, ""), err
    assert out.startswith(f"{ROBOT}: STOPPED, latch 7")
    assert robot.asked


@pytest.mark.parametrize(
    ("above", "mode"),
    [("", "secure"), ("", "Secured"), ("", "tls"), ("[robot.sensors.rear]\nmode = 'secured'", None)],
)
def test_the_command_that_it_names_stops_the_robot_of_a_secured_network(
    above: str,
    mode: str | None,
    tmp_path: Path,
    robot: tuple[Base, str],
    stranger: tuple[Base, str],
    keys: Path,
    environment: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """And not a stranger's, which is called the same and is there, too."""
    right, rendezvous = robot
    spared, address = stranger
    file = tmp_path / "robot.toml"
    file.write_text(f"""[robot]
name = "{ROBOT}"
{above}
[network]
{"" if mode is None else f'mode = "{mode}"'}
rendezvous = "{rendezvous}"
connect = ["{address}"]
keys = "{keys / "desk"}"
[network.access]
robot = ["robot"]
viewers = ["desk"]
""")
    environment.setenv("GIRAFF_CONFIG", str(file))
    code, out, err = typed(environment, capsys, "estop", "engage", "--timeout", "60")
    assert (code, out, spared.asked) == (2, "", [])
    assert err.startswith(
        f"a robot called {ROBOT} at an unknown host has stopped; whether it is yours is not known: {file} "
    )
    right.asked.clear()
    code, _, complaint = typed_here(environment, capsys, named_by(err))
    assert (code, complaint) == (0, ""), err
    assert right.asked
    assert spared.asked == []


def test_where_nothing_can_be_read_the_command_says_what_to_put_in(
    tmp_path: Path,
    robot: tuple[Base, str],
    stranger: tuple[Base, str],
    keys: Path,
    environment: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """Typed as it stands it stops nobody. That the network is secured is seen by this host's keys."""
    right, rendezvous = robot
    spared, _ = stranger
    (tmp_path / "robot.toml").write_text("[robot")
    environment.setenv("GIRAFF_CONFIG", "robot.toml")
    environment.setenv("GIRAFF_NETWORK_KEYS", str(keys / "desk"))
    environment.delenv("GIRAFF_NETWORK_LOCAL")  # which keeps it from any address
    _, _, err = typed(environment, capsys, "estop", "engage")
    assert "NOTHING IS STOPPED: use the battery switch" in err
    command = named_by(err)
    for word in ("NAME: the robot's name", "HOST: the name in the certificate of", "ADDRESS: where that host is"):
        assert f"; {word}" in err
    assert as_typed(f"{command} --timeout 1").returncode == 2
    assert (right.asked, spared.asked) == ([], [])
    for word, meant in {"--robot NAME": f"--robot {ROBOT}", '"HOST"': '"robot"', "ADDRESS": rendezvous}.items():
        assert word in command
        command = command.replace(word, meant)
    done = as_typed(f"{command} --timeout 60")
    assert (done.returncode, done.stderr) == (0, ""), (command, done)
    assert right.asked
    assert spared.asked == []


def test_where_the_name_is_in_doubt_it_is_left_open(
    environment: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    environment.setenv("GIRAFF_ROBOT_NAME", "giraff")
    environment.setenv("GIRAFFE_ROBOT_NAME", "kitchen")
    _, _, err = typed(environment, capsys, "estop", "engage", "--timeout", "0.3")
    assert "env -u GIRAFFE_ROBOT_NAME -u GIRAFF_ROBOT_NAME GIRAFF_CONFIG=/dev/null" in err
    assert "--robot NAME; NAME: the robot's name" in err


def test_a_host_without_keys_is_told_so(
    tmp_path: Path, environment: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    environment.setenv("GIRAFF_NETWORK_MODE", "secure")
    environment.setenv("GIRAFF_NETWORK_KEYS", str(tmp_path))
    _, _, err = typed(environment, capsys, "estop", "engage", "--robot", "anne")
    assert f"; the network is secured, and this host's keys are not in {tmp_path}" in err
    assert "--robot anne --connect ADDRESS" in err
