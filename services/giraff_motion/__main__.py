from giraff_motion.main import main

main()
