from giraff_vision.main import main

main()
