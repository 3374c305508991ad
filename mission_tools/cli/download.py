"""`mission-download`: save what is on board."""

from mission_tools.cli.program import program

main, run_program = program("download")

if __name__ == "__main__":
    main()
