from giraff_base.main import main

main()
