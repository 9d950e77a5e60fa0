from giraff_ranger.main import main

main()
