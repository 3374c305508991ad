"""boat-companion: the program on the boat."""

from companion.cli.interrupts import program

main, run_program = program("boat-companion", "companion.app.cli")

if __name__ == "__main__":
    main()
