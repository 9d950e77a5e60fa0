"""python -m giraff_sim"""

import sys

from giraff_sim.main import main

sys.exit(main())
