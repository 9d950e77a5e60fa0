from giraff_gateway.main import main

main()
