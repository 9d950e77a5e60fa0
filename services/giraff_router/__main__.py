from giraff_router.main import main

main()
