from giraff_sentry.main import main

main()
