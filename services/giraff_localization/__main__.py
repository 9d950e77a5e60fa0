from giraff_localization.main import main

main()
