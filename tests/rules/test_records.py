"""A campaign's record is bound to the files that it judges, and to no others."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.campaign.records import FIRMWARE, PROCESSES, ROBOT, digest, judged, older
from tests.rules.repository import ROOT

CAMPAIGNS = sorted((ROOT / "tests" / "campaign").glob("test_*.py"))


def keep(records: Path, name: str, *files: Path) -> None:
    """A record that is bound to these."""
    told = {"files": {file.name: digest(file) for file in files}}
    (records / name).write_text(json.dumps(told))


def test_a_record_is_older_when_one_of_its_files_is_another_or_none(tmp_path: Path) -> None:
    (tmp_path / "records").mkdir()
    files = [tmp_path / name for name in ("a.py", "b.c", "c.toml", "d.py")]
    for file in files:
        file.write_text("x")
    keep(tmp_path / "records", "2026-11-21-drive.json", *files[:2])
    keep(tmp_path / "records", "2026-11-21-view.json", files[3])

    def found() -> dict[str, str]:
        return older(tmp_path / "records", tmp_path)

    assert found() == {}
    files[2].write_text("of nobody's business")
    assert found() == {}
    files[1].write_text("y")
    assert found() == {"2026-11-21-drive.json": "is older than b.c"}
    files[0].unlink()
    assert found() == {"2026-11-21-drive.json": "is older than a.py, b.c"}
    keep(tmp_path / "records", "2026-11-22-drive.json", files[1])
    assert found() == {}, "only the newest of a campaign counts"


def test_a_record_that_does_not_name_its_files_is_listed(tmp_path: Path) -> None:
    (tmp_path / "2026-11-21-drive.json").write_text("{}")
    assert older(tmp_path) == {"2026-11-21-drive.json": "does not say which files it judged"}


def test_a_viewers_record_is_none_of_the_firmware_and_a_robots_is() -> None:
    view = judged("giraff_viewer.show")
    assert "services/giraff_viewer/show.py" in view
    assert not [name for name in view if name.startswith(("firmware/", "services/giraff_guard/", "tests/"))]
    robot = judged(*PROCESSES, also=ROBOT)
    for name in (
        "firmware/base/drive.c",
        "deploy/robot.toml",
        "services/giraff_guard/policy.py",
        "services/giraff_base/main.py",
        "services/giraff_sim/lockstep/run.c",
        "services/giraff_node/zenoh/peer.toml",
    ):
        assert robot[name] == digest(ROOT / name)
    assert not [name for name in robot if name.startswith(("services/giraff_viewer/", "tests/"))]
    assert all(any(name == part or name.startswith(f"{part}/") for name in robot) for part in (*FIRMWARE, *ROBOT))


@pytest.mark.parametrize("campaign", CAMPAIGNS, ids=lambda path: path.stem)
def test_every_campaign_says_what_it_judges(campaign: Path) -> None:
    text = campaign.read_text()
    assert text.count("write_record(") == 1
    assert "judged(" in text
