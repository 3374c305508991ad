"""`boat-survey`: what a boat's logs say about its water."""

from companion.cli.interrupts import program

main, run_program = program("boat-survey", "mission_tools.cli.survey_command")

if __name__ == "__main__":
    main()
