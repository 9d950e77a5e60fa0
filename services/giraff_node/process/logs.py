"""Structured logs on stderr: one JSON object a line, or plain text when a person watches."""

import logging
import sys
import time
from time import monotonic
from typing import Final

import msgspec

from giraff_schemas.text import printable_lines

BURST: Final = 20
"""Lines of one kind that may come at once."""
EVERY: Final = 5.0
"""s. Time between two lines of one kind after that."""
LONGEST: Final = 2000
"""Characters of a line that is no error. An error may carry the stacks."""


class _Limiter(logging.Filter):
    """Keeps the log short, whoever causes its lines. On an open network a stranger can cause some and write their text.

    The lines of one place in the program are one kind. A record's `about` tells kinds of one place apart. Each kind is
    limited by itself, so that a flood of one does not hide another. Errors are never limited.
    """

    def __init__(self) -> None:
        super().__init__()
        self._kinds: dict[tuple[str, int, str], tuple[float, int]] = {}
        """By kind: monotonic time in s when all its lines may come again, and the number left out since the last."""

    def filter(self, record: logging.LogRecord) -> bool:
        if record.levelno >= logging.ERROR:
            return True
        now, kind = monotonic(), (record.pathname, record.lineno, getattr(record, "about", ""))
        free_at, left_out = self._kinds.get(kind, (now, 0))
        if free_at - now > (BURST - 1) * EVERY:
            self._kinds[kind] = free_at, left_out + 1
            return False
        self._kinds[kind] = max(free_at, now) + EVERY, 0
        more = f" ({left_out} more lines of this kind were left out)" if left_out else ""
        record.msg, record.args = record.getMessage()[: LONGEST - len(more)] + more, ()
        return True


class _PlainFormatter(logging.Formatter):
    def format(self, record: logging.LogRecord) -> str:
        return printable_lines(super().format(record))


class _JsonFormatter(logging.Formatter):
    def format(self, record: logging.LogRecord) -> str:
        entry: dict[str, object] = {
            "time": time.strftime("%Y-%m-%dT%H:%M:%S", time.gmtime(record.created)) + f".{int(record.msecs):03d}Z",
            "level": record.levelname.lower(),
            "service": record.name,
            "message": printable_lines(record.getMessage()),
        }
        if record.exc_info:
            entry["traceback"] = printable_lines(self.formatException(record.exc_info))
        return msgspec.json.encode(entry).decode()


def service_logger(service: str) -> logging.Logger:
    """The logger of this process."""
    handler = logging.StreamHandler(sys.stderr)
    plain = _PlainFormatter("%(asctime)s %(levelname)-7s %(name)s: %(message)s")
    handler.setFormatter(plain if sys.stderr.isatty() else _JsonFormatter())
    handler.addFilter(_Limiter())
    logger = logging.getLogger(service)
    logger.handlers[:] = [handler]
    logger.setLevel(logging.INFO)
    logger.propagate = False
    return logger
