"""What people call a browser's device: by what it says of itself, which is never trusted, and its address."""

import re
from typing import Final

_LONGEST_READ: Final = 512
"""Characters of the header that are looked at."""
_LONGEST_ADDRESS: Final = 45
"""Characters of an IPv6 address at most."""

# The first that is found counts: an iPad's browser also says Mobile, Edge also says Chrome, Chrome also says Safari.
_DEVICES: Final = (
    (r"\biPhone\b", "iPhone"),
    (r"\biPad\b", "iPad"),
    (r"\bAndroid\b.*\bMobile\b", "Android phone"),
    (r"\bAndroid\b", "Android tablet"),
)
_BROWSERS: Final = (
    (r"\bEdgA?/", "Edge"),
    (r"\bOPR/", "Opera"),
    (r"\bFirefox/", "Firefox"),
    (r"\bHeadlessChrome/", "Chromium"),
    (r"\bChrom(e|ium)/", "Chrome"),
    (r"\bSafari/", "Safari"),
    (r"\bcurl/", "curl"),
    (r"^giraff estop$", "giraff estop"),
)
_SYSTEMS: Final = (
    (r"\bWindows\b", "Windows"),
    (r"\bMac OS X\b", "macOS"),
    (r"\bCrOS\b", "ChromeOS"),
    (r"\bLinux\b", "Linux"),
)


def device_name(user_agent: str, address: str) -> str:
    """Like `Android phone at 192.168.1.7`, `Firefox on Linux at 10.0.0.2`. Only words of this file and the address."""
    read = user_agent[:_LONGEST_READ]
    return f"{_kind(read)} at {_shown(address)}"


def _kind(user_agent: str) -> str:
    if device := _first(_DEVICES, user_agent):
        return device
    browser, system = _first(_BROWSERS, user_agent), _first(_SYSTEMS, user_agent)
    return f"{browser or 'browser'} on {system}" if system else browser or "a device"


def _first(patterns: tuple[tuple[str, str], ...], text: str) -> str:
    return next((name for pattern, name in patterns if re.search(pattern, text)), "")


def _shown(address: str) -> str:
    plain = re.sub(r"[^0-9A-Za-z.:]", "", address.partition("%")[0])[:_LONGEST_ADDRESS]
    return plain or "an unknown address"
