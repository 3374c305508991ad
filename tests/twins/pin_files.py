"""Mock pins whose levels outlive the program, as those of a Raspberry Pi do: one file a pin.

gpiozero finds the class by an entry point (`write_entry_point`) and GPIOZERO_MOCK_PIN_CLASS. A script stands
in for `pinctrl`, which is part of Raspberry Pi OS: it sets the same files and records their levels before.
"""

import os
from pathlib import Path

from gpiozero.pins.mock import MockPWMPin

FOLDER = Path(os.environ.get("PIN_FILES", "/run/pins"))
PINCTRL = """#!/bin/sh
# as Raspberry Pi's pinctrl: set PIN,PIN op dl
[ "$1 $3 $4" = "set op dl" ] || exit 1
for pin in $(echo "$2" | tr , ' '); do
    before="$before $pin=$(cat {folder}/GPIO$pin 2>/dev/null || echo 0.0)"
    echo 0.0 > {folder}/GPIO$pin
done
echo $before >> {folder}/pinctrl
"""


class FilePin(MockPWMPin):  # type: ignore[misc]
    """A pin that writes each change of its level to a file."""

    def _change_state(self, value: float) -> bool:
        has_changed: bool = super()._change_state(value)
        if has_changed:
            (FOLDER / self.info.name).write_text(f"{value}\n", encoding="utf-8")
        return has_changed

    def close(self) -> None:
        """The program lets go of the pin; its level stays."""


def write_entry_point(folder: Path) -> None:
    """Make this class known to gpiozero in programs with this folder on their PYTHONPATH."""
    info = folder / "pin_files-1.dist-info"
    info.mkdir(parents=True)
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: pin_files\nVersion: 1\n", encoding="utf-8")
    (info / "entry_points.txt").write_text(
        "[gpiozero_mock_pin_classes]\nfilepin = pin_files:FilePin\n", encoding="utf-8"
    )
    (folder / "pin_files.py").write_text(Path(__file__).read_text(encoding="utf-8"), encoding="utf-8")
