"""Hold the motors' enable pins low, from outside the program: what its unit calls after it, however it ended.

    python -m companion.app.motors_off /etc/mavboat/boat.toml

A bridge whose program was killed goes on with whatever its pins were at. This reads which pins they are, and
loads nothing else: it has to be quick. A file that cannot be read stands for a boat with the default pins.
"""

import shutil
import subprocess
import sys
from pathlib import Path

from companion.config.boat_config import load_config
from companion.config.parts import MotorsPart
from companion.core.errors import ConfigError

_PINCTRL = "pinctrl"  # of Raspberry Pi OS; "op dl" is output, driven low
_LONGEST_S = 5.0


def main(arguments: list[str]) -> int:
    """The exit code: 0 done, 1 the pins could not be set, 2 the file cannot be used."""
    if len(arguments) != 1:
        sys.stderr.write("motors_off: expected the boat's TOML file\n")
        return 2
    code, motors = 0, MotorsPart(driver="l298n")
    try:
        motors = load_config(Path(arguments[0])).parts.motors
    except ConfigError as error:
        sys.stderr.write(f"motors_off: {error}; taking the default pins\n")
        code = 2
    if motors.driver == "none":
        return code
    program, pins = shutil.which(_PINCTRL), f"{motors.left_enable},{motors.right_enable}"
    try:
        if program is None:
            raise FileNotFoundError(f"{_PINCTRL} is not installed")
        subprocess.run([program, "set", pins, "op", "dl"], check=True, timeout=_LONGEST_S)  # noqa: S603
    except (OSError, subprocess.SubprocessError) as error:
        sys.stderr.write(f"motors_off: pins {pins}: {error}\n")
        return 1
    return code


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
