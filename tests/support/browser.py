"""A real Chromium without a screen, and people with phones and laptops in front of it.

What was found of Chromium 156, and why things are as they are here:

- It is started as a process and joined by its debugging port with `no_defaults`: where Playwright itself starts it, it
  holds every page visible and in focus, and no tab can be hidden. Only the phone's pages are such real tabs, in the
  browser's own profile; a laptop is a context of its own, with its own cookies, always visible.
- Another tab in front hides a tab: `blur`, `visibilitychange`, and no animation frame from then on. A minimized window
  only takes the focus.
- `Emulation.setSensorOverrideReadings` of `accelerometer` becomes DeviceMotion's accelerationIncludingGravity, signs as
  on Android, rounded to 0.1 m/s². Events come 60 times a second, also while the readings stay the same, but only if
  linear-acceleration and gyroscope are there, too, and all three before the page listens: else one event of nulls.
- A page that is offline neither says nor hears anything more on a WebSocket that stays open, and `onclose` is not
  called: as a phone that has left the network. What waits is delivered once it is back.
"""

import base64
import math
import os
import random
import signal
import subprocess
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Final
from urllib.parse import urlsplit

from playwright.sync_api import Browser as Chromium
from playwright.sync_api import BrowserContext, ConsoleMessage, Locator, Page, sync_playwright

from giraff_sim.board import BUILD
from tests.support.waiting import wait

CHROMIUM: Final = "/usr/bin/chromium"
AXE: Final = BUILD / "page-tools" / "node_modules" / "axe-core" / "axe.min.js"
"""`make setup` puts it there."""
PATIENCE: Final = 60.0
"""s for whatever comes about."""
_GRAVITY: Final = 9.81
_TREMOR: Final = 0.15
"""m/s², of each axis of a phone in a hand."""
_ANDROID: Final = (
    "Mozilla/5.0 (Linux; Android 14; Pixel 8) AppleWebKit/537.36 (KHTML, like Gecko) "
    "Chrome/156.0.0.0 Mobile Safari/537.36"
)
_SENSORS: Final = ("accelerometer", "linear-acceleration", "gyroscope")
_STILL: Final = {"xyz": {"x": 0.0, "y": 0.0, "z": 0.0}}
PHONE: Final = (412, 915)
LAPTOP: Final = (1280, 800)
"""CSS pixels."""


class Device:
    """One page, and whoever is in front of it."""

    def __init__(self, page: Page) -> None:
        self.page = page
        self.complaints: list[str] = []
        """Errors of the page's console, and those that nothing has caught."""
        self.hosts: set[str] = set()
        """Whom the page has asked for anything."""
        page.set_default_timeout(PATIENCE * 1e3)
        page.on("console", self._on_console)
        page.on("pageerror", lambda error: self.complaints.append(str(error)))
        page.on("request", lambda request: self._on_address(request.url))
        page.on("websocket", lambda socket: self._on_address(socket.url))
        self._cdp = page.context.new_cdp_session(page)

    def send(self, method: str, **parameters: Any) -> Any:
        """A word of the Chrome DevTools Protocol about this page."""
        return self._cdp.send(method, parameters)

    def pause(self, seconds: float) -> None:
        """Let the page go on: its events reach this process only while it waits here."""
        self.page.wait_for_timeout(seconds * 1e3)

    def wait(self, holds: Callable[[], object], what: str, within: float = PATIENCE) -> float:
        """Until it holds; the s that took."""

        def looked() -> object:
            self.pause(0.01)
            return holds()

        return wait(looked, within, what=lambda: f"{what}: {self.told()}", every=0.0)

    def frames(self, count: int) -> None:
        """Let the page draw so many pictures, however long a busy machine takes for them."""
        self.page.evaluate(
            """(left) => new Promise((done) => {
              const next = () => (left-- > 0 ? requestAnimationFrame(next) : done());
              next();
            })""",
            count,
        )

    def told(self) -> str:
        """All text of the page, for a message."""
        return " | ".join(self.page.locator("body").inner_text().split("\n"))

    def tap(self, at: Locator) -> None:
        """Once."""
        at.click()

    def picture(self) -> bytes:
        """PNG. Playwright's own way would turn a phone's screen for a moment, which ends what is held."""
        return base64.b64decode(self.send("Page.captureScreenshot", format="png")["data"])

    def violations(self) -> list[str]:
        """What axe-core finds serious or critical."""
        self.page.evaluate(AXE.read_text())  # a script tag is what the page's policy forbids
        found = self.page.evaluate("() => axe.run(document, {resultTypes: ['violations']})")
        return [
            f"{each['id']}: {each['help']}: {node['html'][:200]}"
            for each in found["violations"]
            if each["impact"] in ("serious", "critical")
            for node in each["nodes"]
        ]

    def be_busy(self, seconds: float) -> None:
        """The page's only thread does nothing else meanwhile."""
        milliseconds = seconds * 1e3
        self.page.evaluate(
            "(most) => { const began = performance.now(); while (performance.now() - began < most); }", milliseconds
        )

    def cut(self, *, off: bool = True) -> None:
        """Take the device off the network, or bring it back."""
        self.send("Network.enable")
        limits = {"latency": 0, "downloadThroughput": -1, "uploadThroughput": -1}
        self.send("Network.emulateNetworkConditions", offline=off, **limits)

    def _on_console(self, message: ConsoleMessage) -> None:
        if message.type == "error":
            self.complaints.append(f"{message.text} ({message.location['url']})")

    def _on_address(self, address: str) -> None:
        if (parts := urlsplit(address)).scheme not in ("data", "blob"):
            self.hosts.add(parts.netloc)


class Phone(Device):
    """In portrait, and held in a hand."""

    def __init__(self, page: Page) -> None:
        super().__init__(page)
        self.resize(*PHONE)
        self.send("Emulation.setTouchEmulationEnabled", enabled=True, maxTouchPoints=5)
        self.send("Emulation.setUserAgentOverride", userAgent=_ANDROID, platform="Android")
        for sensor in _SENSORS:
            self.send("Emulation.setSensorOverrideEnabled", enabled=True, type=sensor, metadata={"available": True})
            self.send("Emulation.setSensorOverrideReadings", type=sensor, reading=_STILL)
        self._random = random.Random(1)
        self._finger: list[dict[str, float]] = []  # that lies there
        self._attitude = (0.0, 0.0)
        self.tilt()

    def resize(self, width: int, height: int) -> None:
        """Be a phone with a screen of so many CSS pixels."""
        portrait = {"type": "portraitPrimary", "angle": 0}
        size = {"width": width, "height": height, "deviceScaleFactor": 2}
        self.send("Emulation.setDeviceMetricsOverride", mobile=True, screenOrientation=portrait, **size)

    def tilt(self, forward: float = 0.0, left: float = 0.0) -> None:
        """Hold it so, degrees from flat: the upper edge down, and the left one."""
        self._attitude = (math.radians(forward), math.radians(left))
        self.tremble()

    def tremble(self) -> None:
        """One more reading of the same attitude, by a hand that is never quite still."""
        forward, left = self._attitude
        up = (math.sin(left) * math.cos(forward), -math.sin(forward), math.cos(left) * math.cos(forward))
        x, y, z = (round(_GRAVITY * axis + self._random.uniform(-_TREMOR, _TREMOR), 1) for axis in up)
        self.send(
            "Emulation.setSensorOverrideReadings", type="accelerometer", reading={"xyz": {"x": x, "y": y, "z": z}}
        )

    def wait(self, holds: Callable[[], object], what: str, within: float = PATIENCE) -> float:
        """The same, in a hand."""

        def looked() -> object:
            self.tremble()
            return holds()

        return super().wait(looked, what, within)

    def hold(self, seconds: float) -> None:
        """Go on holding it so."""
        until = time.monotonic() + seconds
        self.wait(lambda: time.monotonic() >= until, "the time")

    def tap(self, at: Locator) -> None:
        """If a finger lies somewhere, with another one, which is lifted with it."""
        self._send_touch("touchStart", [*self._finger, self._point(at, 0.5, 0.5, 2)])
        if not self._finger:
            self.lift()

    def touch(self, selector: str, right: float = 0.5, down: float = 0.5) -> None:
        """Put a finger down on an element, at these shares of its width and height, and leave it there."""
        self._finger = [self._point(self.page.locator(selector), right, down, 1)]
        self._send_touch("touchStart", self._finger)

    def slide(self, selector: str, right: float, down: float) -> None:
        """Move that finger."""
        self._finger = [self._point(self.page.locator(selector), right, down, 1)]
        self._send_touch("touchMove", self._finger)

    def lift(self) -> None:
        self._finger = []
        self._send_touch("touchEnd", [])

    def _point(self, at: Locator, right: float, down: float, finger: int) -> dict[str, float]:
        box = at.bounding_box()
        assert box is not None, f"{at} is not to be seen: {self.told()}"
        return {"x": box["x"] + right * box["width"], "y": box["y"] + down * box["height"], "id": finger}

    def _send_touch(self, kind: str, points: list[dict[str, float]]) -> None:
        self.send("Input.dispatchTouchEvent", type=kind, touchPoints=points)


class Browser:
    """The process, and the devices that it plays."""

    def __init__(self, process: subprocess.Popen[bytes], chromium: Chromium) -> None:
        self._process = process
        self._chromium = chromium
        self._laptops: list[BrowserContext] = []

    def phone(self) -> Phone:
        """A tab of the browser's own profile, in front of all others. All phones have the same cookies."""
        [context] = self._chromium.contexts[:1]
        return Phone(context.new_page())

    def laptop(self) -> Device:
        """With cookies of its own."""
        width, height = LAPTOP
        context = self._chromium.new_context(
            ignore_https_errors=True, viewport={"width": width, "height": height}, color_scheme="light"
        )
        return Device(context.new_page())

    def hide(self) -> None:
        """Put an empty tab in front of the phone's."""
        [context] = self._chromium.contexts[:1]
        context.new_page()

    def kill(self) -> None:
        """SIGKILL: nothing of it says good-bye."""
        os.killpg(self._process.pid, signal.SIGKILL)
        self._process.wait(PATIENCE)


@contextmanager
def browser(profile: Path) -> Iterator[Browser]:
    """With its profile in a folder that is not there yet. It trusts every certificate, and is gone with the block."""
    profile.mkdir()
    words = [CHROMIUM, "--headless=new", "--no-sandbox", "--no-first-run", "--ignore-certificate-errors"]
    words += ["--remote-debugging-port=0", f"--user-data-dir={profile}", "--disable-background-networking"]
    log = profile / "chromium.log"
    with log.open("wb") as out:
        process = subprocess.Popen([*words, "about:blank"], stdout=out, stderr=out, start_new_session=True)
    try:
        told = profile / "DevToolsActivePort"
        wait(
            lambda: told.exists() and told.read_text().count("\n"),
            PATIENCE,
            what=lambda: f"no Chromium: {log.read_text()}",
        )
        port = told.read_text().split("\n")[0]
        with sync_playwright() as playwright:
            yield Browser(process, playwright.chromium.connect_over_cdp(f"http://127.0.0.1:{port}", no_defaults=True))
    finally:
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)
        process.wait(PATIENCE)
