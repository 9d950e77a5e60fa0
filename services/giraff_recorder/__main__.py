from giraff_recorder.main import main

main()
