import sys

from giraff_keyboard.main import main

sys.exit(main())
