"""`mission-plan`: plan a mission and write it to a file, without a vehicle."""

from companion.cli.interrupts import program

main, run_program = program("mission-plan", "mission_tools.cli.plan_command")

if __name__ == "__main__":
    main()
