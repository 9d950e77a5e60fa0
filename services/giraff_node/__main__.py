import sys

from giraff_node.start import main

sys.exit(main(sys.argv[1:]))
