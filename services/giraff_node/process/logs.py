"""Structured logs on stderr: one JSON object a line, or plain text when a person watches."""

from __future__ import annotations

import logging
import sys
import time

import msgspec

from giraff_schemas.text import printable_lines


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
    logger = logging.getLogger(service)
    logger.handlers[:] = [handler]
    logger.setLevel(logging.INFO)
    logger.propagate = False
    return logger
