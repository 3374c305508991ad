"""`mission-check`: problems in a mission file."""

from mission_tools.cli.program import program

main, run_program = program("check")

if __name__ == "__main__":
    main()
