"""What `giraff doctor` prints: where this host's own keys are of no use any more, and its last line."""

from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest

import giraff_cli.doctor.examine
from giraff_cli.doctor.examine import sum_up
from giraff_cli.doctor.findings import Finding, Severity
from giraff_setup.keys.manage import make_authority, make_bundle
from tests.rules.repository import ROOT
from tests.unit.cli.quiet_network import meet
from tests.unit.cli.typed import Giraff


def test_a_certificate_that_has_expired(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, giraff: Giraff) -> None:
    now = datetime.now(UTC)
    make_authority(tmp_path / "keys", now - timedelta(days=100))
    make_bundle(tmp_path / "keys", "old", ("192.0.2.1",), days=30, renew=False, moment=now - timedelta(days=60))
    access = tmp_path / "secured.toml"
    access.write_text((ROOT / "deploy" / "robot.toml").read_text() + '\n[network.access]\nrobot = ["old"]\n')
    for name, value in (("MODE", "secured"), ("KEYS", str(tmp_path / "keys" / "old")), ("RENDEZVOUS", "127.0.0.1:9")):
        monkeypatch.setenv(f"GIRAFF_NETWORK_{name}", value)
    monkeypatch.setenv("GIRAFF_CONFIG", str(access))
    monkeypatch.setattr(giraff_cli.doctor.examine, "call_all", lambda *_: ())
    meet(monkeypatch)
    code, out, _ = giraff("doctor", "--robot", "sim-far")
    assert code == 1
    [number] = [number for number, line in enumerate(out.splitlines()) if line.startswith("FAULT    certificates: ")]
    fault = " ".join(out.splitlines()[number : number + 2])
    assert "keys of old: expired" in fault
    assert "giraff keys host old" in fault


@pytest.mark.parametrize(
    ("kinds", "told"),
    [
        ((), "no fault"),
        (("note",), "no fault"),
        (("warning",), "no fault, 1 warning"),
        (("fault", "warning", "warning"), "1 fault, 2 warnings"),
    ],
)
def test_the_last_line_counts_warnings_too(kinds: tuple[Severity, ...], told: str) -> None:
    assert sum_up([Finding(severity=kind, about="base", what="", fix="") for kind in kinds]) == told
