"""Types of the fixtures in doctor_fixtures.py, and names of computers."""

from collections.abc import Callable
from pathlib import Path

from companion.app.doctor.findings import Examined

Tree = Callable[[dict[str, str]], Path]
Examine = Callable[..., Examined]

PI_4 = "Raspberry Pi 4 Model B Rev 1.4\0"
