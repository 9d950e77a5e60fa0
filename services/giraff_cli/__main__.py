"""python -m giraff_cli"""

from giraff_cli.main import main

main()
