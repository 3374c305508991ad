"""`boat-companion` whose speed controllers get their pulses from a twin of the kernel's PWM files.

python esc_boat.py FOLDER run --config boat.toml
python esc_boat.py FOLDER motors_off boat.toml

The files stay when it is killed; the record of its pulses is written when it ends.
"""

import json
import sys
import time
from pathlib import Path

from companion.app import motors_off
from companion.app.cli import run_program
from companion.hal.pulses import sysfs_pwm


def main(root: Path, arguments: list[str]) -> int:
    """The program's exit code."""
    sys.path.append(str(Path(__file__).parents[2]))  # last: there is a folder of tests named companion
    from twins.pulses import PI_4, KernelPwm  # noqa: PLC0415

    kernel = KernelPwm(root, PI_4, time.monotonic)
    sysfs_pwm.ROOT = kernel.root
    vars(sysfs_pwm)["os"] = kernel
    is_boat = arguments[0] != "motors_off"
    code = run_program(arguments) if is_boat else motors_off.main(arguments[1:])
    (root / "history.json").write_text(json.dumps(kernel.history), encoding="utf-8")
    return code


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]), sys.argv[2:]))
