"""python -m giraff_cli"""

from giraff_cli.start import main

main()
