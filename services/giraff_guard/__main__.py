from giraff_guard.main import main

main()
