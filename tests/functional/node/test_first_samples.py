"""The first samples of a process come in several of Zenoh's threads at once."""

import subprocess
import sys
from typing import Final

_AT_ONCE: Final = """
import sys, threading
sys.setswitchinterval(1e-6)
import msgspec
from giraff_schemas.codec import decode
from giraff_schemas.topics import GUARD, WHEELS
head = dict(seq=1, stamp_ns=1, instance="a")
verdict = dict(allowed=1.0, clearance="free", sensor="")
ways = dict.fromkeys(("forward", "backward", "turn_left", "turn_right"), verdict)
counts = dict.fromkeys(("left_ticks", "right_ticks", "left_pwm_counts", "right_pwm_counts", "board_us", "boot_id"), 1)
said = {
    GUARD: head | ways | dict(operator="", sensors={}),
    WHEELS: head | counts | dict(left_velocity=0.0, right_velocity=0.0, tick=dict(epoch=1, robot_ns=2)),
}
start = threading.Barrier(12)

def hear(topic):
    payload = msgspec.msgpack.encode(said[topic])
    start.wait()
    decode(topic, f"giraff/r/{topic.key}", payload)

threads = [threading.Thread(target=hear, args=(topic,)) for topic in (*said,) * 6]
for each in threads:
    each.start()
for each in threads:
    each.join()
"""


def test_many_threads_decode_their_first_at_once() -> None:
    """Before, about one process in three was ended by SIGSEGV."""
    codes = [subprocess.run([sys.executable, "-c", _AT_ONCE], check=False).returncode for _ in range(6)]
    assert codes == [0] * 6
