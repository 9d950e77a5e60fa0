"""The log of the pages grows slowly, whatever they do."""

from giraff_web.limited_log import LimitedLog


def test_a_line_a_second_of_each_kind_and_how_many_were_left_out() -> None:
    lines: list[str] = []
    log = LimitedLog(lines.append)
    for n in range(25):
        log.say("stop", "a stop", n * 0.1)
        log.say("reset", "a reset", n * 0.1)
    assert lines == [
        *("a stop", "a reset"),
        *("a stop (9 more since the last line)", "a reset (9 more since the last line)"),
        *("a stop (9 more since the last line)", "a reset (9 more since the last line)"),
    ]
