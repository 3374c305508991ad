"""boat-sitl: the emulator's program."""

from companion.cli.interrupts import program

main, run_program = program("boat-sitl", "sitl.cli.program")

if __name__ == "__main__":
    main()
