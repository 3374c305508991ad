"""`mission-trace`: turn an aerial photograph into a map of its water."""

from companion.cli.interrupts import program

main, run_program = program("mission-trace", "mission_tools.cli.trace_command")

if __name__ == "__main__":
    main()
