"""Gateway: lines of any Arduino to `serial/<name>`, and `serial_write/<name>` to the Arduino.

Two keys, because who publishes and subscribes on one would hear itself, and because access is granted by key: to read a
sensor is not to switch a relay.
"""

from giraff_gateway.config import GatewayConfig
from giraff_gateway.policy import LineSplitter, TimedNotices, WriteQueue, wrong_with
from giraff_node import Node
from giraff_node.boards.serial_link import SerialLink
from giraff_schemas.topics import SERIAL, SERIAL_WRITE
from giraff_schemas.trouble import NO_TROUBLE, Trouble

_TOLD_FOR = 10.0  # s


def main() -> None:
    with Node("gateway", GatewayConfig) as node:
        config = node.config
        link = SerialLink(config.port, config.baud)
        splitter = LineSplitter(config.name, config.longest_line)
        queue = WriteQueue(config.longest_line, config.ending)
        passing = TimedNotices(_TOLD_FOR, "utf-8", "length", "write")
        lines, writes = node.publisher(SERIAL.at(config.name)), node.inbox(SERIAL_WRITE.at(config.name))
        for now in node.turns(link=link):
            if link.keep_open(now):
                splitter = LineSplitter(config.name, config.longest_line)  # what was begun was another life's
            for line in splitter.feed(link.read()):
                lines.put(line)
                for name, trouble in wrong_with(line, config).items():
                    passing.report(name, trouble, now)
            for asked in writes.pop_all():
                passing.report("write", queue.put(asked.text), now)
            passing.report("write", _write(link, queue), now)
            for name, trouble in passing.now(now).items():
                node.set_notice(name, trouble)
            node.set_fault("port", link.fault)


def _write(link: SerialLink, queue: WriteQueue) -> Trouble:
    """Go on writing what waits; what became of it, if that is not well."""
    if link.fault:
        return link.fault.of("texts were not written") if queue.drop() else NO_TROUBLE
    link.flush()
    while link.is_idle and (data := queue.pop()):
        link.send(data)
    return NO_TROUBLE
