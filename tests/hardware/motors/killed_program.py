"""A program that drives two speed controllers until it is killed, and the one that ends their pulses."""

import json
import sys
import threading
import time
from pathlib import Path

from companion.app import motors_off
from companion.config.parts import PulseOutputSetting
from companion.hal.motors.esc import open_escs
from companion.hal.pulses import sysfs_pwm


def main(root: Path, what: str, *arguments: str) -> int:
    """drive, or motors_off with its arguments."""
    sys.path.append(str(Path(__file__).parents[2]))  # last: there is a folder of tests named companion
    from twins.pulses import PI_4, KernelPwm  # noqa: PLC0415

    kernel = KernelPwm(root, PI_4)
    sysfs_pwm.ROOT = kernel.root
    vars(sysfs_pwm)["os"] = kernel
    if what == "motors_off":
        code = motors_off.main(list(arguments))
        sys.stdout.write(json.dumps(kernel.history))
        return code
    settings = (PulseOutputSetting(pin=12), PulseOutputSetting(pin=13))
    motors = open_escs(settings, 0.02, 0.0, time.monotonic, sysfs_pwm.open_sysfs_pulses)
    motors.write(1.0, 1.0)
    sys.stdout.write("driving\n")
    sys.stdout.flush()
    threading.Event().wait()
    return 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]), *sys.argv[2:]))
