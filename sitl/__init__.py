"""The emulator: the companion's own boat over simulated hardware and water."""
