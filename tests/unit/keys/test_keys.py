"""`giraff keys`: what is told, what is refused, and with which exit code."""

import errno
import json
import os
import shutil
from collections.abc import Callable
from datetime import timedelta
from pathlib import Path

import pytest
from cryptography.hazmat.primitives.asymmetric.rsa import generate_private_key
from cryptography.hazmat.primitives.serialization import (
    BestAvailableEncryption,
    Encoding,
    NoEncryption,
    PrivateFormat,
    load_pem_private_key,
)
from typer.testing import CliRunner

from giraff_cli.main import app
from giraff_node.network.session import CERTIFICATES
from giraff_setup.keys import manage as keys
from tests.unit.keys.folders import DAY, NOW, authority, bundle, contents


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(keys, "now", lambda: NOW)
    return tmp_path


def giraff(*words: str) -> tuple[int, str, str]:
    """Exit code, output and complaint of `giraff keys …`."""
    run = CliRunner().invoke(app, ["keys", *words])
    assert run.exception is None or isinstance(run.exception, SystemExit), run.exception
    return run.exit_code, run.stdout, run.stderr


def refusal(*words: str) -> str:
    """Why it is refused; nothing is changed by it."""
    before = contents(Path.cwd())
    code, out, why = giraff(*words)
    assert (code, out) == (2, "")
    assert contents(Path.cwd()) == before
    assert why.count("\n") == 1, "one line, no traceback"
    return why


def listed() -> dict[str, list[str]]:
    """By name, what `list` tells to do; the CA is called CA."""
    told = json.loads(giraff("list", "--json")[1])
    return {"CA": told["ca"]["to_do"]} | {host["name"]: host["to_do"] for host in told["hosts"]}


def test_from_nothing_to_a_bundle_for_each_host() -> None:
    code, out, _ = giraff("init")
    assert code == 0
    assert "until 2036-11-20" in out
    assert "keys/ca.key stays on this machine" in out
    code, out, _ = giraff("host", "robot", "192.168.1.20", "Robot.lan")
    assert code == 0
    assert "keys/robot is made, valid until 2028-11-20" in out
    assert "/etc/giraff/keys" in out
    assert giraff("host", "desk", "10.0.0.3", "--days", "20")[0] == 0
    code, out, _ = giraff("list")
    assert code == 1
    assert [line.split()[-5:] for line in out.splitlines()[2:4]] == [
        ["2026-12-11", "20", "expires", "soon", "10.0.0.3"],
        ["2028-11-20", "730", "ok", "192.168.1.20,", "robot.lan"],
    ]
    assert out.splitlines()[4:] == ["desk: expires soon: giraff keys host desk --renew, then copy it to the host"]


def test_a_bundle_is_what_goes_to_the_host_and_nothing_else() -> None:
    robot = bundle(authority(Path("keys")))
    assert sorted(os.listdir(robot)) == ["bundle.toml", "ca.pem", "host.key", "host.pem"]  # noqa: PTH208
    assert {*CERTIFICATES.values()} == {"ca.pem", "host.key", "host.pem"}, "what services look for"
    assert (robot / "ca.pem").read_bytes() == Path("keys/ca.pem").read_bytes()
    assert Path("keys/.gitignore").read_text(encoding="utf-8") == "*\n"


def test_the_list_for_programs() -> None:
    bundle(authority(Path("keys")))
    code, out, _ = giraff("list", "--json")
    assert code == 0
    told = json.loads(out)
    assert told["folder"] == "keys"
    assert told["ca"]["state"] == "ok"
    [robot] = told["hosts"]
    assert robot == {
        "name": "robot",
        "addresses": ["10.0.0.1", "robot.lan"],
        "expires": "2028-11-20T12:00:00Z",
        "days_left": 730,
        "state": "ok",
        "to_do": [],
    }


def test_a_renewal_keeps_the_addresses_and_takes_a_new_key() -> None:
    robot = bundle(authority(Path("keys"), NOW - 100 * DAY), moment=NOW - 100 * DAY)
    key = (robot / "host.key").read_bytes()
    assert "keys/robot is renewed, valid until 2028-11-20" in giraff("host", "robot", "--renew")[1]
    assert (robot / "host.key").read_bytes() != key
    told = json.loads(giraff("list", "--json")[1])
    assert told["hosts"][0]["addresses"] == ["10.0.0.1", "robot.lan"]
    assert giraff("host", "robot", "10.0.0.9", "--renew")[0] == 0
    assert json.loads(giraff("list", "--json")[1])["hosts"][0]["addresses"] == ["10.0.0.9"]


def test_nothing_is_overwritten() -> None:
    bundle(authority(Path("keys")))
    assert "keys holds a CA already" in refusal("init")
    assert "giraff keys host robot --renew" in refusal("host", "robot", "10.0.0.1")
    Path("other").mkdir()
    assert "other is there already" in refusal("init", "--folder", "other")
    Path("keys/robot/notes").write_text("mine", encoding="utf-8")
    assert "notes with it: move that elsewhere" in refusal("host", "robot", "--renew")
    Path("keys/link").symlink_to("robot")
    assert "keys/link is there already" in refusal("host", "link", "10.0.0.1")
    assert "keys/link is not there, so there is nothing to renew" in refusal("host", "link", "--renew")


def test_a_typo_is_told_before_anything_is_made() -> None:
    assert "--folder" in refusal("host", "robot", "10.0.0.1")
    assert "giraff keys init --folder kees" in refusal("list", "--folder", "kees")
    assert "there is no such folder" in refusal("init", "--folder", "nowhere/keys")
    bundle(authority(Path("keys")))
    assert "no address: name each one at which other hosts reach desk" in refusal("host", "desk")
    assert "'tls/10.0.0.1:7447' is neither" in refusal("host", "desk", "tls/10.0.0.1:7447")
    assert "'my desk' cannot be part of a key" in refusal("host", "my desk", "10.0.0.1")
    assert "is the bundle of one host" in refusal("list", "--folder", "keys/robot")
    assert "giraff keys host desk ADDRESS" in refusal("host", "desk", "--renew")
    assert "'../desk' cannot be part of a key" in refusal("host", "../desk", "10.0.0.1")


def test_a_clock_that_jumped_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(keys, "now", lambda: NOW.replace(year=1970))
    assert "this machine's clock says 1970-11-21: set it" in refusal("init")
    bundle(authority(Path("keys")))
    assert "this machine's clock says 1970-11-21: set the clock" in refusal("host", "desk", "10.0.0.1")
    assert giraff("list")[0] == 1
    assert listed()["robot"] == [
        "not yet valid: this machine's clock says 1970-11-21 12:00 UTC: set it, if it is wrong"
    ]
    monkeypatch.setattr(keys, "now", lambda: NOW.replace(year=2040))
    assert "if the clock is right, make a new CA in another folder" in refusal("host", "desk", "10.0.0.1")
    assert listed()["CA"][0].startswith("expired: make a new CA")
    assert "-4384" in giraff("list")[1]


def test_a_ca_that_ends_first_makes_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    authority(Path("keys"))
    monkeypatch.setattr(keys, "now", lambda: NOW + 3600 * DAY)
    assert "the CA ends on 2036-11-20, and what it signs must end before: --days 52" in refusal(
        "host", "robot", "10.0.0.1"
    )
    assert giraff("host", "robot", "10.0.0.1", "--days", "52")[0] == 0


def spoil_nothing(_robot: Path) -> None:
    """As it was made."""


def loosen(robot: Path) -> None:
    (robot / "host.key").chmod(0o640)


def take_another_key(robot: Path) -> None:
    shutil.copy("keys/ca.key", robot / "host.key")


def copy_from_another_ca(robot: Path) -> None:
    shutil.rmtree(robot)
    shutil.copytree(bundle(authority(Path("other"))), robot)


def take_another_ca(robot: Path) -> None:
    shutil.copy(authority(Path("other")) / "ca.pem", robot / "ca.pem")


def take_another_certificate(robot: Path) -> None:
    other = bundle(robot.parent, "desk")
    for name in ("host.pem", "host.key"):
        shutil.move(other / name, robot / name)
    shutil.rmtree(other)


def keep_the_old_note(robot: Path) -> None:
    note = (robot / "bundle.toml").read_bytes()
    bundle(robot.parent, moment=NOW + timedelta(hours=1), renew=True)
    (robot / "bundle.toml").write_bytes(note)


def cut(name: str) -> Callable[[Path], None]:
    def spoil(robot: Path) -> None:
        (robot / name).write_bytes((robot / name).read_bytes()[:90])

    return spoil


def lose(name: str) -> Callable[[Path], None]:
    return lambda robot: (robot / name).unlink()


def protect(robot: Path) -> None:
    key = load_pem_private_key((robot / "host.key").read_bytes(), None)
    secret = BestAvailableEncryption(b"secret")
    (robot / "host.key").write_bytes(key.private_bytes(Encoding.PEM, PrivateFormat.PKCS8, secret))


def take_a_key_of_another_kind(robot: Path) -> None:
    key = generate_private_key(65537, 2048)
    (robot / "host.key").write_bytes(key.private_bytes(Encoding.PEM, PrivateFormat.PKCS8, NoEncryption()))


@pytest.mark.parametrize(
    ("spoil", "code", "to_do"),
    [
        (spoil_nothing, 0, None),
        (loosen, 1, "key readable by others: chmod 600 keys/robot/host.key; if others use this machine"),
        (take_another_key, 1, "key does not match: giraff keys host robot --renew"),
        (copy_from_another_ca, 1, "not signed by this CA: giraff keys host robot --renew"),
        (take_another_ca, 1, "not signed by this CA: giraff keys host robot --renew"),
        (take_another_certificate, 1, "bundle mixed up: it is the bundle of 'desk': call the folder so again"),
        (
            keep_the_old_note,
            1,
            "bundle mixed up: bundle.toml is of another certificate: giraff keys host robot --renew",
        ),
        (cut("host.pem"), 2, "keys/robot/host.pem is damaged, or no certificate in PEM"),
        (cut("host.key"), 2, "cannot be read: keys/robot/host.key is damaged, or no private key in PEM"),
        (cut("ca.pem"), 2, "keys/robot/ca.pem is damaged"),
        (cut("bundle.toml"), 2, "keys/robot/bundle.toml is damaged"),
        (lose("host.pem"), 2, "keys/robot/host.pem cannot be read: No such file or directory"),
        (lose("host.key"), 2, "keys/robot/host.key cannot be read: No such file or directory"),
        (lose("bundle.toml"), 2, "keys/robot/bundle.toml cannot be read: No such file or directory"),
        (protect, 2, "keys/robot/host.key has a passphrase"),
        (take_a_key_of_another_kind, 2, "keys/robot/host.key is not a key that `giraff keys` made"),
    ],
    ids=lambda value: getattr(value, "__name__", None),
)
def test_the_list_tells_what_is_wrong_with_a_bundle_and_what_to_do(
    spoil: Callable[[Path], None], code: int, to_do: str | None
) -> None:
    robot = bundle(authority(Path("keys")))
    bundle(Path("keys"), "laptop")
    spoil(robot)
    assert giraff("list")[0] == code
    told = listed()
    assert told["laptop"] == []
    assert told["CA"] == []
    assert [to_do in sentence for sentence in told["robot"]] == [True] if to_do else told["robot"] == []
    if "--renew" in "".join(told["robot"]):
        assert giraff("host", "robot", "10.0.0.1", "--renew")[0] == 0
        assert giraff("list")[0] == 0, "it is the way out"


def test_the_worst_is_told_first_and_nothing_is_left_out(monkeypatch: pytest.MonkeyPatch) -> None:
    robot = bundle(authority(Path("keys")))
    loosen(robot)
    monkeypatch.setattr(keys, "now", lambda: NOW + 731 * DAY)
    assert [sentence.split(":")[0] for sentence in listed()["robot"]] == ["key readable by others", "expired"]
    assert json.loads(giraff("list", "--json")[1])["hosts"][0]["state"] == "key readable by others"


def test_thirty_days_before_it_expires_the_list_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    bundle(authority(Path("keys")))
    for left, code in ((30 * DAY, 0), (30 * DAY - timedelta(seconds=1), 1), (timedelta(), 1)):
        monkeypatch.setattr(keys, "now", lambda left=left: NOW + 730 * DAY - left)
        assert giraff("list")[0] == code


def test_a_ca_whose_key_is_kept_elsewhere_lists_and_does_not_sign() -> None:
    bundle(authority(Path("keys")))
    Path("keys/ca.key").rename("ca.key")
    assert giraff("list")[0] == 0
    assert "keys/ca.key is not here, and only it can sign" in refusal("host", "desk", "10.0.0.1")


def test_a_ca_with_the_key_of_another_does_not_sign() -> None:
    bundle(authority(Path("keys")))
    shutil.copy(authority(Path("other")) / "ca.key", "keys/ca.key")
    assert "keys/ca.key is not the key of keys/ca.pem" in refusal("host", "desk", "10.0.0.1")
    assert listed()["CA"][0].startswith("key does not match: one of both is of another CA")


def test_a_ca_key_that_others_can_read_is_told() -> None:
    authority(Path("keys"))
    Path("keys/ca.key").chmod(0o644)
    code, out, _ = giraff("list")
    assert code == 1
    assert "chmod 600 keys/ca.key; if others use this machine, take it for lost" in out
    assert "No host has a bundle yet." in out


def test_a_damaged_ca_is_named() -> None:
    bundle(authority(Path("keys")))
    Path("keys/ca.pem").write_text("-----BEGIN CERTIFICATE-----\n", encoding="utf-8")
    assert "keys/ca.pem is damaged" in refusal("list")
    assert "keys/ca.pem is damaged" in refusal("host", "desk", "10.0.0.1")


def test_a_damaged_bundle_is_renewed_when_its_addresses_are_named_again() -> None:
    robot = bundle(authority(Path("keys")))
    cut("host.pem")(robot)
    assert "name the addresses of robot again" in refusal("host", "robot", "--renew")
    assert giraff("host", "robot", "10.0.0.1", "--renew")[0] == 0


def test_a_folder_elsewhere_is_named_in_what_to_type(here: Path) -> None:
    folder = str(here / "my keys")
    out = giraff("init", "--folder", folder)[1]
    assert f"giraff keys host robot 192.168.1.20 --folder '{folder}'" in out
    assert giraff("host", "robot", "10.0.0.1", "--folder", folder)[0] == 0


def test_somebody_elses_folder_is_told_as_such(monkeypatch: pytest.MonkeyPatch) -> None:
    authority(Path("keys"))

    def deny(path: str, *_arguments: object) -> int:
        raise PermissionError(13, "Permission denied", str(path))

    monkeypatch.setattr(os, "open", deny)
    code, _, why = giraff("host", "robot", "10.0.0.1")
    assert code == 2
    assert why == (
        "giraff keys host: keys: Permission denied: whose is it? The one who made the CA makes the bundles, too\n"
    )


def test_a_folder_that_cannot_be_written_is_named_and_no_temporary_one(
    here: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(path: Path, **_: object) -> None:
        raise OSError(errno.EROFS, os.strerror(errno.EROFS), str(path))

    monkeypatch.setattr(Path, "mkdir", refuse)
    told = f"giraff keys init: {here}: Read-only file system; name a folder where you may write with --folder\n"
    assert refusal("init") == told
