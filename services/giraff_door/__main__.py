from giraff_door.main import main

main()
