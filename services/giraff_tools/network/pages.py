"""Where a robot serves its pages: kept from each visit, so that a stop can go there when Zenoh does not answer."""

import contextlib
import threading
import time
from pathlib import Path
from typing import Final

import msgspec
import zenoh

from giraff_node.network.replies import ask_all
from giraff_node.process.state import state_directory, write_file_durably
from giraff_schemas.health import Health, WebPage
from giraff_schemas.services import WEB
from giraff_schemas.topics import health_key

_MOST_PAGES: Final = 4  # on an open network anybody may tell one
_MOST_HOSTS: Final = 8
_MOST_QUESTIONS: Final = 20  # of one command
_ANSWER_WITHIN: Final = 5.0  # s
_ASK_AGAIN: Final = 1.0  # s


def page_file(robot: str) -> Path:
    """Return the file of this robot's pages. Several robots may share a state folder."""
    return state_directory(robot) / f"page-{robot}.json"


def kept_pages(robot: str) -> tuple[WebPage, ...]:
    """Return the pages of the last visit that heard any; empty: none is known."""
    try:
        return msgspec.json.decode(page_file(robot).read_bytes(), type=tuple[WebPage, ...])
    except (OSError, ValueError, RecursionError):  # msgspec's errors are ValueErrors
        return ()


class PageKeeper:
    """Asks for the pages of one robot, and keeps the answers. The command neither waits for it nor fails by it."""

    def __init__(self) -> None:
        self._pages: dict[WebPage, None] = {}
        self._questions = 0
        self._lock = threading.Lock()
        self._threads: list[threading.Thread] = []

    def ask(self, session: zenoh.Session, robot: str) -> None:
        """Ask where the pages are. Each answer is written by a thread of its own: a disk may hang."""

        def on_health(health: Health) -> None:
            if health.page is not None:
                self._add(robot, health.page)
            elif health.service == WEB.name:  # it has just begun, and does not listen yet
                self._ask_later(session, robot)

        self._questions += 1
        if self._questions <= _MOST_QUESTIONS:
            with contextlib.suppress(zenoh.ZError):
                ask_all(session, health_key(robot, WEB.name), Health, on_health, _ANSWER_WITHIN)

    def wait(self, within: float) -> None:
        """Wait `within` s at most for what is being written."""
        until = time.monotonic() + within
        for thread in self._threads:
            thread.join(max(0.0, until - time.monotonic()))

    def _ask_later(self, session: zenoh.Session, robot: str) -> None:
        timer = threading.Timer(_ASK_AGAIN, self.ask, (session, robot))
        timer.daemon = True
        timer.start()

    def _add(self, robot: str, page: WebPage) -> None:
        page = msgspec.structs.replace(page, hosts=page.hosts[:_MOST_HOSTS])
        if page not in self._pages and len(self._pages) < _MOST_PAGES:
            self._pages[page] = None
            thread = threading.Thread(target=self._keep, args=(robot,), daemon=True)
            self._threads.append(thread)
            thread.start()

    def _keep(self, robot: str) -> None:
        # Without a page that is kept, a stop goes over Zenoh alone, as before: nobody need be told.
        with self._lock, contextlib.suppress(OSError):
            pages = tuple(self._pages)
            if kept_pages(robot) != pages:
                file = page_file(robot)
                file.parent.mkdir(parents=True, exist_ok=True)
                write_file_durably(file, msgspec.json.encode(pages))
