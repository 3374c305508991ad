"""`mission-upload`: plan a mission, upload it, start it and follow it."""

from mission_tools.cli.program import program

main, run_program = program("upload")

if __name__ == "__main__":
    main()
