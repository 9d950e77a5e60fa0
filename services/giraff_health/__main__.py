import sys

from giraff_health.ask import main

sys.exit(main(sys.argv[1:]))
