import os

# Read once, when zenoh is imported. A place whose connection ends takes all its links with it at one moment, and a dead
# link's close blocks a receiving thread for up to 10 s: with 16 threads, 60 links that went froze all others as long.
os.environ.setdefault("ZENOH_RUNTIME", "(rx: (worker_threads: 64))")

from giraff_router.main import main

main()
