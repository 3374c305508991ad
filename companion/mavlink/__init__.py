"""MAVLink without I/O: bytes to messages and back, mission items, and the machines that transfer a list."""
