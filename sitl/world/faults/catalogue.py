"""What can go wrong with which part, as [[faults]] of a scenario names it.

The kinds are MAVLink's FAILURE_TYPE where it has one. Every kind has a size, whose meaning and usual value
stand in the table.
"""

import math
from typing import NamedTuple

from companion.config.section import NonNegative, Positive, Section


class Effect(NamedTuple):
    """What a kind of fault does. size: its usual size; text: what happens, in words that say what size is."""

    size: float
    text: str
    low: float = -math.inf  # bounds of the size
    high: float = math.inf


def _timing(slow: float, delayed_s: float, period_s: float) -> dict[str, Effect]:
    return {
        "off": Effect(0.0, "silent"),
        "slow": Effect(slow, "only every size-th reading arrives", 1.0),
        "delayed": Effect(
            delayed_s, "readings arrive size seconds late, with current time stamps", 0.0, 60.0
        ),
        "intermittent": Effect(period_s, "silent for the first half of every size seconds", 0.04),
        "corrupt": Effect(
            0.01, "the share size of the readings is garbled, or is the last but one", 0.0, 1.0
        ),
    }


_MOTOR = {
    "off": Effect(0.0, "no thrust, whatever the command"),
    "wrong": Effect(-1.0, "runs in reverse; size is the gain of the command", -1.0, 1.0),
    "slow": Effect(0.5, "weak; size is the gain of the command", -1.0, 1.0),
    "stuck": Effect(1.0, "weed blocks the propeller; size 0..1: most motors stall at 0.4", 0.0, 1.0),
    "weed": Effect(0.2, "weed on the propeller; size 0..1: most motors stall at 0.4", 0.0, 1.0),
    "intermittent": Effect(2.0, "a loose contact: no thrust in the first half of every size seconds", 0.04),
}

CATALOGUE: dict[str, dict[str, Effect]] = {
    "gnss": {
        **_timing(10.0, 2.0, 4.0),
        "no_fix": Effect(0.0, "sends readings without a fix"),
        "stuck": Effect(0.0, "repeats one position and velocity, with current time stamps"),
        "garbage": Effect(1000.0, "positions anywhere within size metres", 0.0),
        "wrong": Effect(10.0, "jumps by size metres towards towards_deg and stays there"),
        "drift": Effect(0.5, "spoofed: drifts at size m/s towards towards_deg"),
        "jammed": Effect(5.0, "noise grows for size seconds, then no fix", 0.04),
    },
    "compass": {
        **_timing(50.0, 1.0, 2.0),
        "stuck": Effect(0.0, "repeats one heading, with current time stamps"),
        "garbage": Effect(0.0, "any heading"),
        "wrong": Effect(45.0, "off by size degrees"),
        "drift": Effect(2.0, "drifts by size degrees a second"),
    },
    "gyro": {
        "off": Effect(0.0, "silent"),
        "stuck": Effect(0.0, "repeats one turn rate"),
        "corrupt": Effect(0.01, "the share size of the rates is garbled, or is the last but one", 0.0, 1.0),
        "garbage": Effect(60.0, "any rate up to size degrees a second", 0.0),
        "wrong": Effect(5.0, "off by size degrees a second"),
    },
    "sonar": {
        **_timing(10.0, 1.0, 2.0),
        "stuck": Effect(0.0, "the same range at every bearing"),
        "deaf": Effect(0.0, "pings without echoes"),
        "garbage": Effect(0.0, "any range"),
        "wrong": Effect(-0.5, "ranges off by size metres"),
    },
    "depth": {
        **_timing(10.0, 1.0, 4.0),
        "stuck": Effect(0.0, "repeats one depth, with current time stamps"),
        "deaf": Effect(0.0, "finds no bottom"),
        "garbage": Effect(0.0, "any depth"),
        "wrong": Effect(-1.0, "depths off by size metres"),
    },
    "battery": {
        **_timing(50.0, 5.0, 10.0),
        "stuck": Effect(0.0, "repeats one voltage and current"),
        "garbage": Effect(0.0, "any voltage and current"),
        "wrong": Effect(-2.0, "the voltage is off by size volts"),
    },
    "rc": {
        **_timing(50.0, 1.0, 4.0),
        "failsafe": Effect(0.0, "has lost its transmitter and reports it"),
        "stuck": Effect(0.0, "repeats the same channels, with current time stamps"),
        "garbage": Effect(0.0, "any pulse on every channel"),
        "wrong": Effect(
            900.0,
            "has lost its transmitter and sends preset pulses: throttle size µs",
            500.0,
            2500.0,
        ),
    },
    "leak": {
        "wet": Effect(0.0, "water at the probe in the hull"),
        "intermittent": Effect(
            2.0, "sloshing water: at the probe for the first half of every size seconds", 0.04
        ),
        "off": Effect(0.0, "the probe is silent"),
    },
    "thermometer": {
        "hot": Effect(10.0, "the hull heats by size °C a minute, up to 110", 0.0),
        "wrong": Effect(20.0, "off by size degrees Celsius"),
        "off": Effect(0.0, "silent"),
    },
    "motor_left": _MOTOR,
    "motor_right": _MOTOR,
    "rudder": {
        "off": Effect(0.0, "the blade is lost, or trails freely"),
        "stuck": Effect(0.0, "stands where it is"),
        "wrong": Effect(10.0, "off by size degrees, positive to starboard", -45.0, 45.0),
    },
    "link": {
        "off": Effect(0.0, "no frames in either direction"),
        "slow": Effect(300.0, "size bytes a second each way", 1.0),
        "delayed": Effect(2.0, "a delay of size seconds", 0.0),
        "intermittent": Effect(4.0, "no frames in the first half of every size seconds", 0.04),
        "lossy": Effect(0.5, "the share size is lost each way", 0.0, 1.0),
    },
    "computer": {"off": Effect(0.0, "no power; the boat's program restarts when power returns")},
    "cpu": {"slow": Effect(1.5, "too slow: the program needs size times its tick", 0.0)},
    "clock": {"wrong": Effect(10.0, "jumps ahead by size seconds, as after a hang; never back", 0.0)},
    "disk": {"off": Effect(0.0, "full: nothing is stored")},
}


class FaultSetting(Section, frozen=True):
    """One fault: what fails, how, from when on and for how long (else for good).

    towards_deg: clockwise from north, for what is pulled away. Raises ValueError: no such part, a kind of
    fault that it cannot have, or a size that makes no sense.
    """

    what: str
    kind: str = "off"
    at_s: NonNegative = 0.0
    for_s: Positive | None = None
    size: float | None = None
    towards_deg: float = 90.0

    def __post_init__(self) -> None:
        super().__post_init__()
        kinds = CATALOGUE.get(self.what)
        if kinds is None:
            raise ValueError(f"what = {self.what!r}: expected one of {', '.join(CATALOGUE)}")
        if self.kind not in kinds:
            raise ValueError(f"kind = {self.kind!r}: {self.what} can be {', '.join(sorted(kinds))}")
        effect = kinds[self.kind]
        if not effect.low <= self.amount <= effect.high:
            raise ValueError(
                f"size = {self.amount:g}: expected {effect.low:g} to {effect.high:g} ({effect.text})"
            )

    @property
    def amount(self) -> float:
        """The size, or the usual one of its kind."""
        return CATALOGUE[self.what][self.kind].size if self.size is None else self.size

    @property
    def ends_s(self) -> float:
        """When it is over; infinite if it lasts."""
        return math.inf if self.for_s is None else self.at_s + self.for_s
