"""A service's threads share their heaps, and what was large goes back to the machine."""

import subprocess
import sys

_LIBC = """
import ctypes, sys, threading
if sys.argv[1:]:
    import giraff_node.start
libc = ctypes.CDLL(None)
"""
_COUNT = """
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
_LARGE = """
libc.malloc.restype, libc.free.argtypes = ctypes.c_void_p, (ctypes.c_void_p,)
libc.malloc.argtypes = (ctypes.c_size_t,)
libc.free(libc.malloc(8 << 20))  # from here on glibc takes blocks of up to 8 MiB for small
class Info(ctypes.Structure):
    _fields_ = [("sizes", ctypes.c_size_t * 10)]  # struct mallinfo2; the fifth is that of all mappings
libc.mallinfo2.restype = Info
libc.malloc(1 << 20)
print(libc.mallinfo2().sizes[4])
"""


def printed(script: str, *words: str) -> str:
    """By a process of its own; with any words one that has imported giraff_node.start."""
    command = [sys.executable, "-c", _LIBC + script, *words]
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def test_threads_of_a_service_share_two_heaps() -> None:
    assert printed(_COUNT).count("<heap ") > 2
    assert printed(_COUNT, "giraff_node.start").count("<heap ") == 2


def test_a_large_block_is_a_mapping_of_its_own() -> None:
    """So that it goes back when it is freed, whatever was freed before."""
    mapped, by_itself = int(printed(_LARGE, "giraff_node.start")), int(printed(_LARGE))
    assert mapped - by_itself >= 1 << 20
