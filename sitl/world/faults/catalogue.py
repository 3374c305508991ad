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
        "off": Effect(0.0, "says nothing any more"),
        "slow": Effect(slow, "only every size-th reading comes", 1.0),
        "delayed": Effect(
            delayed_s, "readings come size seconds late, stamped as if they were fresh", 0.0, 60.0
        ),
        "intermittent": Effect(period_s, "silent for the first half of every size seconds", 0.04),
    }


_MOTOR = {
    "off": Effect(0.0, "no thrust, whatever the command"),
    "wrong": Effect(-1.0, "turns the other way round; size is the gain of the command", -1.0, 1.0),
    "slow": Effect(0.5, "weak; size is the gain of the command", -1.0, 1.0),
    "stuck": Effect(
        1.0, "weed holds the propeller; size is how much of it, 0..1: at 0.4 most motors stall", 0.0, 1.0
    ),
    "weed": Effect(
        0.2, "weed on the propeller; size is how much of it, 0..1: at 0.4 most motors stall", 0.0, 1.0
    ),
    "intermittent": Effect(2.0, "a loose contact: no thrust in the first half of every size seconds", 0.04),
}

CATALOGUE: dict[str, dict[str, Effect]] = {
    "gnss": {
        **_timing(10.0, 2.0, 4.0),
        "no_fix": Effect(0.0, "goes on talking, without a fix"),
        "stuck": Effect(0.0, "the same position and velocity again and again, stamped fresh"),
        "garbage": Effect(1000.0, "positions anywhere within size metres", 0.0),
        "wrong": Effect(10.0, "jumps by size metres towards towards_deg and stays there"),
        "drift": Effect(0.5, "spoofed: pulled away at size m/s towards towards_deg"),
        "jammed": Effect(5.0, "noise grows for size seconds; then it stands still without a fix", 0.04),
    },
    "compass": {
        **_timing(50.0, 1.0, 2.0),
        "stuck": Effect(0.0, "the same heading again and again, stamped fresh"),
        "garbage": Effect(0.0, "any heading"),
        "wrong": Effect(45.0, "off by size degrees"),
        "drift": Effect(2.0, "turns away by size degrees a second"),
    },
    "gyro": {
        "off": Effect(0.0, "says nothing any more"),
        "stuck": Effect(0.0, "the same rate again and again"),
        "garbage": Effect(60.0, "any rate up to size degrees a second", 0.0),
        "wrong": Effect(5.0, "off by size degrees a second"),
    },
    "sonar": {
        **_timing(10.0, 1.0, 2.0),
        "stuck": Effect(0.0, "the same range at every bearing"),
        "deaf": Effect(0.0, "pings go out, and no echo is heard"),
        "garbage": Effect(0.0, "any range"),
        "wrong": Effect(-0.5, "ranges off by size metres"),
    },
    "battery": {
        **_timing(50.0, 5.0, 10.0),
        "stuck": Effect(0.0, "the same voltage and current again and again"),
        "garbage": Effect(0.0, "any voltage and current"),
        "wrong": Effect(-2.0, "the voltage is off by size volts"),
    },
    "rc": {
        **_timing(50.0, 1.0, 4.0),
        "failsafe": Effect(0.0, "has lost its transmitter, and says so"),
        "stuck": Effect(0.0, "the same channels again and again, stamped fresh"),
        "garbage": Effect(0.0, "any pulse on every channel"),
        "wrong": Effect(
            900.0,
            "has lost its transmitter, and puts out pulses set for that: throttle size µs",
            500.0,
            2500.0,
        ),
    },
    "leak": {
        "wet": Effect(0.0, "water at the probe in the hull"),
        "intermittent": Effect(
            2.0, "water that sloshes: at the probe for the first half of every size seconds", 0.04
        ),
        "off": Effect(0.0, "the probe says nothing any more"),
    },
    "thermometer": {
        "hot": Effect(10.0, "it gets hotter in the hull by size degrees Celsius a minute, up to 110", 0.0),
        "wrong": Effect(20.0, "off by size degrees Celsius"),
        "off": Effect(0.0, "says nothing any more"),
    },
    "motor_left": _MOTOR,
    "motor_right": _MOTOR,
    "link": {
        "off": Effect(0.0, "nothing comes through either way"),
        "slow": Effect(300.0, "size bytes a second each way", 1.0),
        "delayed": Effect(2.0, "everything takes size seconds longer", 0.0),
        "intermittent": Effect(4.0, "nothing comes through in the first half of every size seconds", 0.04),
        "lossy": Effect(0.5, "a share of size is lost each way", 0.0, 1.0),
    },
    "computer": {"off": Effect(0.0, "no power; when it is back, the boat's program begins anew")},
    "cpu": {"slow": Effect(1.5, "too slow: the boat's program needs size times the tick that it has", 0.0)},
    "clock": {
        "wrong": Effect(10.0, "leaps ahead by size seconds, as if the program had hung; never goes back", 0.0)
    },
    "disk": {"off": Effect(0.0, "full: nothing can be stored")},
}


class FaultSetting(Section, frozen=True):
    """One fault: what fails, how, from when on and for how long (else for good).

    towards_deg: clockwise from north, for what is pulled away.

    Raises:
        ValueError: no such part, a kind of fault that it cannot have, or a size that makes no sense.
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
