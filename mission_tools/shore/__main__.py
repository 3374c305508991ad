"""boat-shore: the page's program."""

from companion.cli.interrupts import program

main, run_program = program("boat-shore", "mission_tools.shore.program")

if __name__ == "__main__":
    main()
