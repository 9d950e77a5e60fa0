"""Draw pictures of docs/pictures, first README.md's room.png: `.venv/bin/python scripts/pictures.py`.

All are of a simulated robot that drives itself and has found its place on the map of its room: its page on a laptop and
on a phone, and what `giraff view` makes of a recording. It needs /usr/bin/chromium and takes three minutes. Robot, room
and noise are always those of one seed, and the pictures are taken after the same way, so new ones differ by little.
"""

import os
import signal
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any, Final, cast

from playwright.sync_api import sync_playwright

PICTURES: Final = Path(__file__).parents[1] / "docs" / "pictures"
GIRAFF: Final = str(Path(sys.executable).with_name("giraff"))
ROBOT: Final = "giraff"
WAY: Final = 8.0
"""m that the robot has driven at least."""
RUN: Final = (GIRAFF, "run", "--local", "--web", "--localize", "--boards", "host", "--seed", "3")
LIGHT: Final[dict[str, Any]] = {"ignore_https_errors": True, "color_scheme": "light"}
ANDROID: Final = "Mozilla/5.0 (Linux; Android 14; Pixel 8) AppleWebKit/537.36 Chrome/156.0.0.0 Mobile Safari/537.36"
SHOWS_IT: Final = f"""() => {{
  const told = (id) => document.getElementById(id).textContent;
  const at = told("floor-text");
  const free = document.querySelectorAll(".tiles [data-clearance=free]").length === 4;
  return free && parseFloat(told("path")) >= {WAY} && parseFloat(told("speed")) > 0.2 && at.includes("Localized on");
}}"""


def main() -> None:
    environment = {name: value for name, value in os.environ.items() if not name.startswith("GIRAFF_")}
    environment |= {"GIRAFF_ROBOT_NAME": ROBOT, "GIRAFF_WEB_PORT": "0"}
    environment["GIRAFF_BASE_DRIVE__BATTERY_VOLTS_PER_COUNT"] = "0.03"
    with tempfile.TemporaryDirectory() as folder:
        environment["XDG_STATE_HOME"] = folder
        recording = str(Path(folder) / "drive.mcap")
        with subprocess.Popen(RUN, env=environment, stdout=subprocess.PIPE, text=True) as robot:
            try:
                lines = iter(robot.stdout or ())
                connect = next(line for line in lines if "--connect" in line).split()[-1]
                address = next(line for line in lines if line.startswith("page: ")).split()[1]
                record = (GIRAFF, "record", "--output", recording, "--robot", ROBOT, "--connect", connect)
                with subprocess.Popen(record, env=environment) as recorder:
                    draw(address)
                    recorder.send_signal(signal.SIGINT)
            finally:
                robot.send_signal(signal.SIGTERM)
        view = (GIRAFF, "view", recording, "--picture", str(PICTURES / "view.png"))
        subprocess.run(view, env=environment, check=True)


def draw(address: str) -> None:
    """Save pages as they are when the robot has driven far enough and knows where it is; one page at a time."""
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path="/usr/bin/chromium", args=["--no-sandbox"])
        laptop = browser.new_context(**LIGHT, viewport={"width": 1280, "height": 800})
        phone = browser.new_context(
            **LIGHT, viewport={"width": 412, "height": 915}, device_scale_factor=2, has_touch=True, user_agent=ANDROID
        )
        bare = address.partition("#")[0]  # a page that watches has the most room for its plan
        for context, at, name in ((laptop, bare, "room"), (laptop, address, "web-laptop"), (phone, bare, "web-phone")):
            page = context.new_page()
            page.goto(at)
            page.wait_for_function(SHOWS_IT, timeout=200_000)
            page.screenshot(path=PICTURES / f"{name}.png")
            page.close()
            phone.add_cookies(cast("Any", laptop.cookies()))  # one address lets one device drive
        browser.close()


if __name__ == "__main__":
    main()
