"""What can be typed wrong in `giraff logs`, and what it says."""

from __future__ import annotations

ROWS: tuple[tuple[tuple[str, ...], str], ...] = (
    (("logs", "bas"), "giraff logs: there is no service 'bas'; did you mean 'base'?\n"),
    (("logs", "base", "giraff@base"), "there is no service 'giraff@base'; known are: base, camera, door, "),
    (("logs", "--since", "yesterday"), "--since: 'yesterday' is no time: give one like 10min, 2h, 14:30 or 2026-"),
    (("logs", "-f", "--since", "14:75"), "--since: '14:75' is no time"),
    (("logs", "--since", "-5min"), "--since: '-5min' is no time"),
    (("logs", "--level", "loud"), "'--level': 'loud' is not one of 'info', 'warning', 'error'"),
)
