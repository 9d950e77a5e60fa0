"""A service's threads share their heaps."""

from __future__ import annotations

import subprocess
import sys

_COUNT = """
import ctypes, sys, threading
if sys.argv[1:]:
    import giraff_node
libc = ctypes.CDLL(None)
libc.malloc.restype = libc.fopen.restype = ctypes.c_void_p
libc.malloc_info.argtypes, libc.fclose.argtypes = (ctypes.c_int, ctypes.c_void_p), (ctypes.c_void_p,)
met = threading.Barrier(12)
threads = [threading.Thread(target=lambda: (libc.malloc(5000), met.wait())) for _ in range(12)]
for thread in threads:
    thread.start()
for thread in threads:
    thread.join()
file = libc.fopen(b"/dev/stdout", b"w")
libc.malloc_info(0, file)
libc.fclose(file)
"""


def heaps(*words: str) -> int:
    """Of a process with a dozen threads, all of which allocate."""
    done = subprocess.run([sys.executable, "-c", _COUNT, *words], check=True, capture_output=True, text=True)
    return done.stdout.count("<heap ")


def test_threads_of_a_service_share_two_heaps() -> None:
    assert heaps() > 2
    assert heaps("giraff_node") == 2
