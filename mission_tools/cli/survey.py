"""`boat-survey`: what a boat's logs say about its water."""

from mission_tools.cli.program import program

main, run_program = program("survey", "boat")

if __name__ == "__main__":
    main()
