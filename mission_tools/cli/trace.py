"""`mission-trace`: turn an aerial photograph into a map of its water."""

from mission_tools.cli.program import program

main, run_program = program("trace")

if __name__ == "__main__":
    main()
