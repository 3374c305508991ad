"""`mission-upload`: plan a mission, upload it, start it and follow it."""

from companion.cli.interrupts import program

main, run_program = program("mission-upload", "mission_tools.cli.upload_command")

if __name__ == "__main__":
    main()
