from giraff_camera.main import main

main()
