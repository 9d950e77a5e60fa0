"""The viewer's process: rerun's own program, in a process group of its own, which is ended as a whole."""

import contextlib
import os
import signal
import subprocess
import tempfile
import time
from pathlib import Path
from types import TracebackType
from typing import Final, Self

import rerun_cli
from rerun.experimental import ViewerClient

from giraff_viewer.machine import GIVE_BACK, LATECOMERS, NO_VULKAN

PICTURE_SIZE: Final = "1600x1000"

_START_WITHIN: Final = 30.0  # s; without a graphics card, on a machine that does other things
_SHOWN_WITHIN: Final = 60.0  # s
_POPUPS_GONE: Final = 40
"""Frames after which the viewer no longer tells about itself over the picture. Without a screen each one counts as 0.25
s of a pop-up's 4 s, however long it took, and an idle viewer draws one a second."""
_SETTLE: Final = 1.0  # s that the views take for what has come
_END_WITHIN: Final = 3.0  # s
_NO_GRAPHICS: Final = "Failed to get render context"
"""In the viewer's last words, where it finds nothing that draws."""


class ViewerError(Exception):
    """There is no viewer. The message says why, and the way out."""


class Window:
    """A viewer on this machine's screen, or with `headless` on none."""

    def __init__(self, port: int, memory: str, *, headless: bool) -> None:
        self.url = f"rerun+http://127.0.0.1:{port}/proxy"
        self._said = tempfile.TemporaryFile()  # noqa: SIM115  closed with the window
        self._began = time.monotonic()
        command = [str(Path(rerun_cli.__file__).with_name("rerun")), "--bind", "127.0.0.1", "--port", str(port)]
        command += ["--memory-limit", memory, "--server-memory-limit", LATECOMERS, "--hide-welcome-screen"]
        command += ["--headless", "--window-size", PICTURE_SIZE] if headless else ["--expect-data-soon"]
        try:
            self._process = subprocess.Popen(
                command,
                stdin=subprocess.DEVNULL,
                stdout=self._said,
                stderr=self._said,
                env=GIVE_BACK | os.environ,
                start_new_session=True,
            )
        except OSError as error:
            raise ViewerError(f"{command[0]} cannot be started: {error.strerror}") from error

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    @property
    def pid(self) -> int:
        return self._process.pid

    def is_open(self) -> bool:
        """Whether it is still there. Raises ViewerError where it has not ended well."""
        code = self._process.poll()
        if code:
            raise ViewerError(f"the viewer ended with {code}: {self._last_word()}")
        return code is None

    def picture(self, path: Path, newest: float) -> None:
        """Write what it shows as PNG, as soon as it shows the moment `newest` (s since 1970). Raises ViewerError."""
        deadline = time.monotonic() + _SHOWN_WITHIN
        frames = 0
        while frames < _POPUPS_GONE:
            if self.shows(newest):
                frames += 1  # it answers while it draws
                continue
            if time.monotonic() > deadline:
                raise ViewerError(f"the viewer has not shown everything within {_SHOWN_WITHIN:g} s")
            time.sleep(0.1)
        time.sleep(_SETTLE)
        part = path.absolute().with_name(f".{path.name}.part.png")
        try:
            self._client().save_screenshot(str(part))
            part.replace(path)
        except (OSError, RuntimeError) as error:
            part.unlink(missing_ok=True)
            with contextlib.suppress(subprocess.TimeoutExpired):
                self._process.wait(_END_WITHIN)  # whoever falls over takes a moment to say why
            self.is_open()
            raise ViewerError(f"{path}: no picture: {_first_line(error)}") from error

    def close(self) -> None:
        """End it, and whatever it has started."""
        for number in (signal.SIGTERM, signal.SIGKILL):
            with contextlib.suppress(ProcessLookupError):
                os.killpg(self._process.pid, number)
            with contextlib.suppress(subprocess.TimeoutExpired):
                self._process.wait(_END_WITHIN)
                break
        self._said.close()

    def shows(self, moment: float) -> bool:
        """Whether it has all up to a moment, s since 1970; not while it is too busy to say so. Raises ViewerError."""
        self.is_open()
        try:
            return _newest(self._client()) >= moment - 1e-3
        except (ConnectionError, TimeoutError):
            return False

    def _client(self) -> ViewerClient:
        while True:
            try:
                return ViewerClient(url=self.url)
            except ConnectionError as error:
                if not self.is_open() or time.monotonic() > self._began + _START_WITHIN:
                    raise ViewerError(f"the viewer does not answer: {self._last_word()}") from error
                time.sleep(0.1)

    def _last_word(self) -> str:
        self._said.seek(0)
        said = self._said.read().decode(errors="replace")
        if _NO_GRAPHICS in said:
            return NO_VULKAN
        lines = said.split("\n")
        telling = [line.strip() for line in lines if "panicked" in line or "Error" in line or "ERROR" in line]
        return telling[-1][:300] if telling else "it does not say why; try --web, or --save"


def _newest(client: ViewerClient) -> float:
    ends = [
        timeline.end
        for each in client.get_state().recordings
        for timeline in each.timelines
        if timeline.name == "time" and timeline.end is not None
    ]
    return max(ends, default=0) * 1e-9


def _first_line(error: Exception) -> str:
    return str(error).partition("\n")[0]
