"""`mission-download`: save what is on board."""

from companion.cli.interrupts import program

main, run_program = program("mission-download", "mission_tools.cli.download_command")

if __name__ == "__main__":
    main()
