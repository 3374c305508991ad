"""`mission-plan`: plan a mission and write it to a file, without a vehicle."""

from mission_tools.cli.program import program

main, run_program = program("plan")

if __name__ == "__main__":
    main()
