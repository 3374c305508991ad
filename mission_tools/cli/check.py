"""`mission-check`: problems in a mission file."""

from companion.cli.interrupts import program

main, run_program = program("mission-check", "mission_tools.cli.check_command")

if __name__ == "__main__":
    main()
