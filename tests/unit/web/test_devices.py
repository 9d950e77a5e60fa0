"""What people call a browser's device."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from giraff_web.devices import device_name

AT = "192.168.1.7"


@pytest.mark.parametrize(
    ("user_agent", "name"),
    [
        (
            "Mozilla/5.0 (Linux; Android 10; K) AppleWebKit/537.36 Chrome/130.0.0.0 Mobile Safari/537.36",
            "Android phone",
        ),
        ("Mozilla/5.0 (Android 14; Mobile; rv:132.0) Gecko/132.0 Firefox/132.0", "Android phone"),
        ("Mozilla/5.0 (Linux; Android 13; SM-X200) AppleWebKit/537.36 Chrome/130.0 Safari/537.36", "Android tablet"),
        (
            "Mozilla/5.0 (iPhone; CPU iPhone OS 18_1 like Mac OS X) Version/18.1 Mobile/15E148 Safari/604.1",
            "iPhone",
        ),
        ("Mozilla/5.0 (iPad; CPU OS 12_5 like Mac OS X) AppleWebKit/605.1.15 Mobile/15E148", "iPad"),
        ("Mozilla/5.0 (X11; Linux x86_64; rv:132.0) Gecko/20100101 Firefox/132.0", "Firefox on Linux"),
        (
            "Mozilla/5.0 (Windows NT 10.0; Win64; x64) AppleWebKit/537.36 Chrome/130.0 Safari/537.36 Edg/130.0",
            "Edge on Windows",
        ),
        (
            "Mozilla/5.0 (Windows NT 10.0; Win64; x64) AppleWebKit/537.36 Chrome/130.0 Safari/537.36",
            "Chrome on Windows",
        ),
        (
            "Mozilla/5.0 (Macintosh; Intel Mac OS X 10_15_7) Version/18 Safari/605",
            "Safari on macOS",
        ),
        ("Mozilla/5.0 (X11; CrOS x86_64) AppleWebKit/537.36 Chrome/130.0 Safari/537.36", "Chrome on ChromeOS"),
        ("Mozilla/5.0 (X11; Linux x86_64) AppleWebKit/537.36 HeadlessChrome/156.0 Safari/537.36", "Chromium on Linux"),
        ("curl/8.5.0", "curl"),
        ("", "a device"),
        ("\x1b[31m\n\x00" * 1000, "a device"),
    ],
)
def test_it_is_named_as_people_do(user_agent: str, name: str) -> None:
    assert device_name(user_agent, AT) == f"{name} at {AT}"


@pytest.mark.parametrize(
    ("address", "shown"),
    [
        ("fe80::1%eth0", "fe80::1"),
        ("::ffff:10.0.0.7", "::ffff:10.0.0.7"),
        ("", "an unknown address"),
        ("10.0.0.7\n\x1b[2J", "10.0.0.72J"),
    ],
)
def test_so_is_its_address(address: str, shown: str) -> None:
    assert device_name("", address) == f"a device at {shown}"


@given(st.text(max_size=2000), st.text(max_size=200))
def test_no_header_says_more_than_words_of_ours(user_agent: str, address: str) -> None:
    name = device_name(user_agent, address)
    assert name.isprintable()
    assert name.isascii()
    assert len(name) < 80
