"""How a service is: what is wrong with itself, what it only notices of others, what it speaks of and listens to."""

import logging
import os
import socket
import time
from pathlib import Path

from giraff_node.process.version import version
from giraff_schemas.health import Health, WebPage
from giraff_schemas.trouble import NO_TROUBLE, Trouble


class HealthState:
    """What is wrong now. Each change is logged once; any thread may tell of one."""

    def __init__(self, service: str, instance: str, log: logging.Logger) -> None:
        self._service = service
        self._instance = instance
        self._log = log
        self._started = time.monotonic()
        self._faults: dict[str, Trouble] = {}
        self._notices: dict[str, Trouble] = {}
        self.publishes: list[str] = []
        """Keys of the topics table; the same one may be told twice."""
        self.subscribes: list[str] = []
        self.answers: list[str] = []
        self.page: WebPage | None = None

    def set_fault(self, name: str, trouble: Trouble) -> None:
        """State what is wrong with `name` of this service itself, or with NO_TROUBLE that nothing is."""
        self._set(self._faults, name, trouble)

    def set_notice(self, name: str, trouble: Trouble) -> None:
        """State what keeps the service from being of use and is not its own doing, or with NO_TROUBLE that nothing
        does."""
        self._set(self._notices, name, trouble)

    def health(self) -> Health:
        faults, notices = tuple(self._faults.values()), tuple(self._notices.values())
        return Health(
            service=self._service,
            instance=self._instance,
            host=socket.gethostname(),
            pid=os.getpid(),
            uptime=time.monotonic() - self._started,
            ok=not faults,
            faults=faults,
            notices=notices,
            publishes=tuple(dict.fromkeys(self.publishes)),
            subscribes=tuple(dict.fromkeys(self.subscribes)),
            answers=tuple(dict.fromkeys(self.answers)),
            cpu_time=time.process_time(),
            rss_bytes=_resident(),
            version=version(),
            stamp_ns=time.time_ns(),
            page=self.page,
        )

    @property
    def faults(self) -> str:
        """What is wrong with the service itself, a line each; empty: it is well."""
        return "".join(f"{fault}\n" for fault in tuple(self._faults.values()))

    @property
    def summary(self) -> str:
        """One line for people."""
        return "; ".join(map(str, (*self._faults.values(), *self._notices.values()))) or "well"

    def _set(self, told: dict[str, Trouble], name: str, trouble: Trouble) -> None:
        if told.get(name, NO_TROUBLE) == trouble:
            return
        trouble = Trouble(_text(trouble.what), _text(trouble.remedy), trouble.action, _text(trouble.argument))
        about = {"about": name.partition(" ")[0]}  # a few words: keys and operators, which strangers invent, come after
        if told.get(name, NO_TROUBLE) == trouble:
            return
        if trouble:
            told[name] = trouble
            self._log.warning("%s", trouble, extra=about)
        else:
            told.pop(name, None)  # another subscriber's thread may have done so just now
            self._log.info("recovered: %s", name, extra=about)


def _text(text: str) -> str:
    """A port's path may be no text, and JSON is."""
    return text.encode(errors="replace").decode()


def _resident() -> int:
    """Bytes of memory that this process has in use; 0 where the kernel does not tell."""
    try:
        pages = int(Path("/proc/self/statm").read_bytes().split()[1])
    except OSError:
        return 0
    return pages * os.sysconf("SC_PAGE_SIZE")
