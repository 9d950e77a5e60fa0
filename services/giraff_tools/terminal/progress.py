"""How far long work has come, on the last line of a terminal."""

import contextlib
import select
import sys
import time
from types import TracebackType
from typing import TYPE_CHECKING, Final, Self

from giraff_tools.terminal.output import is_drawn_on

if TYPE_CHECKING:
    import rich.progress

_AFTER: Final = 0.5  # s; shorter work shows nothing, and imports nothing
_EVERY: Final = 0.25  # s


class Progress:
    """A bar with per cent and the time that is left, on standard error. Without a terminal there it shows nothing.

    Standard output may be the same terminal: `hide` it before anything is printed. No clock but the monotonic one
    counts, and a terminal that is paused holds nothing up.
    """

    def __init__(self, title: str, total: float | None = 1.0, *, shown: bool = True) -> None:
        """`total`: amount of the work. None: nobody knows. `shown`: a person should see it."""
        self._title = title
        self._total = total
        self._is_shown = shown and is_drawn_on(sys.stderr)
        self._next = time.monotonic() + _AFTER
        self._bar: rich.progress.Progress | None = None
        self._task: rich.progress.TaskID | None = None

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.hide()

    def move(self, done: float) -> None:
        """Show how much is done. It costs nothing where there is nothing to show yet."""
        if not self._is_shown or (now := time.monotonic()) < self._next:
            return
        self._next = now + _EVERY
        if not select.select([], [sys.stderr], [], 0.0)[1]:
            return
        with contextlib.suppress(OSError):  # the terminal may be gone
            self.prepare()
            assert self._bar is not None and self._task is not None  # noqa: S101, PT018  of `prepare`
            self._bar.update(self._task, completed=done if self._total is None else min(done, self._total))
            if self._bar.live.is_started:
                self._bar.refresh()
            else:
                self._bar.start()

    def prepare(self) -> None:
        """Make the bar now. Its imports would hold up work that keeps time."""
        if self._is_shown and self._bar is None:
            self._bar = _bar(ends=self._total is not None)
            self._task = self._bar.add_task(self._title, total=self._total)

    def hide(self) -> None:
        """Clear the line. The next move shows it again."""
        if self._bar is not None:
            with contextlib.suppress(OSError):
                self._bar.stop()


def _bar(*, ends: bool) -> "rich.progress.Progress":
    import rich.progress as of  # noqa: PLC0415  for work that takes long

    from giraff_telemetry.console import CleanConsole  # noqa: PLC0415

    class Console(CleanConsole):
        def show_cursor(self, show: bool = True) -> bool:
            """Leave it as it is: a command that a signal ends could not bring it back."""
            del show
            return False

    end = (of.TaskProgressColumn(), of.TimeRemainingColumn()) if ends else (of.TimeElapsedColumn(),)
    return of.Progress(
        of.TextColumn("{task.description}"),
        of.BarColumn(),
        *end,
        console=Console(stderr=True, highlight=False),
        transient=True,
        auto_refresh=False,
        redirect_stdout=False,
        redirect_stderr=False,
    )
