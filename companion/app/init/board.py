"""What of a configuration depends on the model of the Pi."""

from typing import Final

from companion.app.init.toml_edit import Value

_VALUES: Final[tuple[tuple[str, dict[str, Value]], ...]] = (  # docs/first-day.md has the table
    # There, /dev/serial0 is the debug connector (Raspberry Pi documentation, Configure UARTs)
    ("Raspberry Pi 5", {"parts.gnss.port": "/dev/ttyAMA0", "rc.port": "/dev/ttyAMA3"}),
    # One UART on the header: the receiver of a transmitter needs an adapter
    ("Raspberry Pi 3", {"rc.port": "/dev/ttyUSB0"}),
    ("Raspberry Pi Zero 2", {"rc.port": "/dev/ttyUSB0"}),
)


def board_values(model: str) -> dict[str, Value]:
    """Values other than those of a Pi 4, by key."""
    return next((values for name, values in _VALUES if model.startswith(name)), {})
