from giraff_joystick.main import main

main()
