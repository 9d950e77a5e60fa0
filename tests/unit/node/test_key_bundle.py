"""What a host without the library for certificates can tell of its keys."""

from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest

from giraff_node.network.key_bundle import BUNDLE_FILE, BundleError, ExpiryWatch, read_bundle
from giraff_schemas.trouble import NO_TROUBLE

TEXT = """
name = "robot"
addresses = ["10.0.0.1"]
made = 2026-11-21T12:00:00Z
expires = 2028-11-20T12:00:00Z
"""


def test_a_bundle_tells_whose_it_is_and_until_when(tmp_path: Path) -> None:
    (tmp_path / BUNDLE_FILE).write_text(TEXT)
    bundle = read_bundle(tmp_path)
    assert (bundle.name, bundle.addresses) == ("robot", ("10.0.0.1",))
    assert bundle.expires == datetime(2028, 11, 20, 12, tzinfo=UTC)


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("", "`name` is missing"),
        (TEXT.replace('"robot"', "3"), "name must be text, and is a number"),
        (TEXT.replace("Z", ""), "made needs a time zone"),
        (TEXT.replace("2028-11-20T12:00:00Z", '"soon"'), "expires must be a date with its time, and is text"),
        ("name = ", "a value is missing"),
        ("name = '\udc80'", "no text"),
    ],
)
def test_a_damaged_one_says_why(tmp_path: Path, text: str, why: str) -> None:
    (tmp_path / BUNDLE_FILE).write_bytes(text.encode(errors="surrogateescape"))
    with pytest.raises(BundleError, match=rf"bundle\.toml is damaged: .*{why}"):
        read_bundle(tmp_path)


def test_a_missing_one_is_named(tmp_path: Path) -> None:
    with pytest.raises(BundleError, match=r"bundle\.toml cannot be read: No such file"):
        read_bundle(tmp_path)


@pytest.mark.parametrize(
    ("left", "warning"),
    [
        (timedelta(days=730), ""),
        (timedelta(days=30), ""),
        (
            timedelta(days=29),
            "the keys of robot expire on 2028-11-20; `giraff keys host robot --renew`, copy them here",
        ),
        (timedelta(), "the keys of robot have expired, no link comes about; `giraff keys host robot --renew`"),
        (timedelta(days=731), ""),
        (timedelta(days=732), "not valid yet: this machine's clock says 2026-11-19 12:00 UTC; set it"),
    ],
)
def test_a_process_warns_before_its_keys_fail_it(tmp_path: Path, left: timedelta, warning: str) -> None:
    (tmp_path / BUNDLE_FILE).write_text(TEXT)
    said = ExpiryWatch(tmp_path).warning(datetime(2028, 11, 20, 12, tzinfo=UTC) - left)
    assert warning in str(said)
    assert bool(warning) == bool(said)


def test_keys_that_were_renewed_meanwhile_count_from_the_next_start(tmp_path: Path) -> None:
    (tmp_path / BUNDLE_FILE).write_text(TEXT)
    watch = ExpiryWatch(tmp_path)
    (tmp_path / BUNDLE_FILE).write_text(TEXT.replace("2028-11", "2030-11"))
    assert "have expired" in str(watch.warning(datetime(2029, 1, 1, tzinfo=UTC)))
    assert ExpiryWatch(tmp_path).warning(datetime(2029, 1, 1, tzinfo=UTC)) == NO_TROUBLE


def test_where_nothing_can_be_told_that_is_told(tmp_path: Path) -> None:
    assert "nobody is warned before this host's keys expire" in str(ExpiryWatch(tmp_path).warning(datetime.now(UTC)))
