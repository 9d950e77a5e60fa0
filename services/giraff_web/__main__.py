from giraff_web.main import main

main()
