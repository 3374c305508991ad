"""What of a configuration depends on the model of the Pi."""

from pathlib import Path
from typing import Final

from companion.app.init.toml_edit import Value

MODEL: Final = Path("/proc/device-tree/model")

_VALUES: Final[tuple[tuple[str, dict[str, Value]], ...]] = (  # docs/first-day.md has the table
    # There, /dev/serial0 is the debug connector (Raspberry Pi documentation, Configure UARTs)
    ("Raspberry Pi 5", {"parts.gnss.port": "/dev/ttyAMA0", "rc.port": "/dev/ttyAMA3"}),
    # One UART on the header: the receiver of a transmitter needs an adapter
    ("Raspberry Pi 3", {"rc.port": "/dev/ttyUSB0"}),
    ("Raspberry Pi Zero 2", {"rc.port": "/dev/ttyUSB0"}),
)


def read_model(path: Path = MODEL) -> str:
    """The name of this machine's model; empty if it has none."""
    try:
        return path.read_text(encoding="utf-8", errors="replace").rstrip("\0\n")
    except OSError:
        return ""


def board_values(model: str) -> dict[str, Value]:
    """Values other than those of a Pi 4, by key."""
    return next((values for name, values in _VALUES if model.startswith(name)), {})
