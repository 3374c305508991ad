"""Configuration of motors and rudder: drivers, servo signals, layout, and how the hull answers."""

import math
from typing import Annotated, Literal

from msgspec import Meta, structs

from companion.config.board import PULLED_UP, I2cBus, OptionalPin, Pin
from companion.config.section import NonNegative, Positive, Section, Share
from companion.core.units import clamp

PulseWidth = Annotated[int, Meta(ge=500, le=2500)]


class PulseOutputSetting(Section, frozen=True):
    """The signal of one servo or ESC.

    output: "hardware", the Pi's own PWM on GPIO 12, 13, 18 or 19; "software", lgpio on any pin, with the
    jitter of the scheduler; or "pca9685", a channel of that chip, whose frequency is set in [parts.pca9685].
    trim_us is the pulse of zero: centre, or stop. Equal to min_us it stands for an ESC without reverse.
    """

    output: Literal["hardware", "software", "pca9685"] = "hardware"
    pin: OptionalPin = -1  # BCM number, for "hardware" and "software"
    channel: Annotated[int, Meta(ge=0, le=15)] = 0  # of the PCA9685
    frequency_hz: Annotated[int, Meta(ge=50, le=400)] = 50  # analogue servos take 50 only
    min_us: PulseWidth = 1100
    trim_us: PulseWidth = 1500
    max_us: PulseWidth = 1900
    reversed: bool = False

    def __post_init__(self) -> None:
        super().__post_init__()
        if not self.min_us <= self.trim_us <= self.max_us or self.min_us == self.max_us:
            raise ValueError(
                f"expected min_us ≤ trim_us ≤ max_us, got {self.min_us}, {self.trim_us}, {self.max_us}"
            )
        if self.max_us >= 1e6 / self.frequency_hz:
            raise ValueError(
                f"max_us = {self.max_us}: expected less than the period of {self.frequency_hz} Hz"
            )

    def width_us(self, share: float) -> float:
        """Width for a share of full travel, −1 to 1; trim_us for a value that is not finite."""
        if not math.isfinite(share):
            return self.trim_us
        share = clamp(-share if self.reversed else share, -1.0, 1.0)
        return self.trim_us + share * (
            self.max_us - self.trim_us if share > 0.0 else self.trim_us - self.min_us
        )

    def limited_us(self, width_us: float) -> float:
        """The nearest width that the part may get; trim_us for a value that is not finite."""
        return clamp(width_us, self.min_us, self.max_us) if math.isfinite(width_us) else self.trim_us


class Pca9685Part(Section, frozen=True):
    """A PCA9685 with 16 servo signals.

    Boards leave the factory with address 0x40, that of the INA219; with A0 bridged it is 0x41. oscillator_hz:
    25 MHz is typical; boards differ by some percent, and pulses with them. Measure a pulse, or put the error
    into trim_us. output_enable: the pin at OE, low while the program runs; with a resistor to 3.3 V the
    signals end when the Pi is reset, which does not reset the chip. −1: OE is wired to ground.
    """

    address: Annotated[int, Meta(ge=0x40, le=0x7F)] = 0x41
    frequency_hz: Annotated[int, Meta(ge=50, le=400)] = 50
    oscillator_hz: Annotated[float, Meta(ge=20e6, le=30e6)] = 25e6
    output_enable: OptionalPin = -1
    i2c_bus: I2cBus = 1


class MotorsPart(Section, frozen=True):
    """The motor driver. Pins in BCM numbers.

    Bridges have pins: forward, backward and enable ("l298n", "bts7960"), PWM as enable ("tb6612"), or forward
    and backward only ("drv8833"). Speed controllers ("esc") have signals instead: left and right. VESCs
    ("vesc") are driven over their ports, which report too.

    telemetry: what speed controllers on signals send over their ports: frames of KISS, as BLHeli_32 and AM32
    send them, or a VESC's answers. can_id: of a right VESC that is reached over the left one's CAN bus.
    """

    driver: Literal["l298n", "tb6612", "bts7960", "drv8833", "esc", "vesc", "autopilot", "none"] = "none"
    left_forward: Pin = 5
    left_backward: Pin = 6
    left_enable: Pin = 12
    right_forward: Pin = 20
    right_backward: Pin = 21
    right_enable: Pin = 13
    pwm_hz: Annotated[int, Meta(ge=50, le=10000)] = 1000  # the maximum of lgpio
    dead_time_s: NonNegative = 0.02
    left_reversed: bool = False
    right_reversed: bool = False
    left: PulseOutputSetting = PulseOutputSetting(pin=12)
    right: PulseOutputSetting = PulseOutputSetting(pin=13)
    arming_s: NonNegative = 3.0  # neutral pulses before the first command; ESCs arm on them
    telemetry: Literal["kiss", "vesc", "none"] = "none"
    left_port: str = "/dev/ttyAMA3"
    right_port: str = "/dev/ttyAMA2"
    can_id: Annotated[int, Meta(ge=-1, le=253)] = -1  # −1: the right one has a port
    pole_pairs: Annotated[int, Meta(ge=1, le=50)] = 7  # half of the magnets; SERVO_BLH_POLES is 14
    telemetry_timeout_s: Positive = 1.0  # silent without a reading: 30 at 30 Hz
    hot_c: NonNegative = 85.0  # told above; VESC's l_temp_fet_start, where it begins to limit. 0: never

    @property
    def protocol(self) -> str:
        """What the ports carry."""
        return "vesc" if self.driver == "vesc" else self.telemetry

    def ports(self, *, has_right: bool) -> dict[str, str]:
        """Those of speed controllers that report, by key, left first."""
        ports = {"left_port": self.left_port, "right_port": self.right_port}
        if self.protocol == "none":
            return {}
        is_alone = not has_right or (self.protocol == "vesc" and self.can_id >= 0)
        return {"left_port": self.left_port} if is_alone else ports

    @property
    def signals(self) -> tuple[PulseOutputSetting, PulseOutputSetting]:
        """The speed controllers' signals, left and right, with left_reversed and right_reversed in them."""
        left = structs.replace(self.left, reversed=self.left.reversed != self.left_reversed)
        return left, structs.replace(self.right, reversed=self.right.reversed != self.right_reversed)

    def pins(self, *, has_right: bool) -> dict[str, int]:
        """The pins of a bridge, by key."""
        if self.driver in ("none", "esc", "vesc", "autopilot"):
            return {}
        names = ("forward", "backward") if self.driver == "drv8833" else ("forward", "backward", "enable")
        sides = ("left", "right") if has_right else ("left",)
        return {f"{side}_{name}": getattr(self, f"{side}_{name}") for side in sides for name in names}

    def stop_pins(self, *, has_right: bool) -> list[int]:
        """Those that stop a bridge when they are low: its enables, or all where it has none."""
        pins = self.pins(has_right=has_right)
        return [pin for key, pin in pins.items() if key.endswith("enable")] or list(pins.values())

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.telemetry != "none" and self.driver not in ("esc", "vesc"):
            raise ValueError(f"telemetry = {self.telemetry!r}: expected 'none' with {self.driver!r}")
        if self.driver == "esc":
            for name, signal in zip(("left", "right"), self.signals, strict=True):
                if signal.reversed and signal.trim_us == signal.min_us:
                    raise ValueError(
                        f"{name}: without reverse it cannot be reversed; swap two of the motor's wires"
                    )
        if self.driver == "drv8833":
            for name in ("left_forward", "left_backward", "right_forward", "right_backward"):
                if getattr(self, name) in PULLED_UP:
                    raise ValueError(
                        f"{name} = {getattr(self, name)}: GPIO 0 to 8 are high at reset and would run the "
                        "motor; expected another"
                    )


class RudderPart(Section, frozen=True):
    """The rudder's servo. Its longest pulse turns the bow to starboard, with `reversed` the shortest.

    min_us and max_us are the ends of the linkage, not of the servo: at most 35° of rudder, where it stalls.
    """

    driver: Literal["servo", "autopilot", "none"] = "none"
    signal: PulseOutputSetting = PulseOutputSetting(pin=13)


class DriveSetting(Section, frozen=True):
    """layout: two motors side by side; one motor (the left channel) and a rudder; or two motors and a rudder.

    The rest describes the rudder. Its yaw moment is proportional to its angle, up to the stall near 35°,
    where the linkage must end, and to the square of the water's speed at the blade. Full rudder at cruise
    speed is the full steering effort of the heading loop. The square of the speed at the blade, in shares of
    that at cruise, is

        (1 − wash) (u / cruise speed)² + wash (throttle / cruise throttle)²        throttle ahead only

    wash: how much of it at cruise is propeller wash; 0 if the blade lies outside the wash. astern: moment
    going astern relative to ahead. steerage_m_s: below this speed through the water the helm adds throttle
    for wash over the rudder. kick_throttle: most throttle that it adds. turn_radius_m: smallest turning
    radius under way, with some rudder left to steer.
    """

    layout: Literal["differential", "rudder", "differential_rudder"] = "differential"
    wash: Share = 0.5
    astern: Share = 0.3
    steerage_m_s: NonNegative = 0.6
    kick_throttle: Share = 0.5
    turn_radius_m: Positive = 3.0
    slew_per_s: Annotated[float, Meta(gt=0.0, le=50.0)] = 3.0  # of the rudder, amidships to one end is 1

    @property
    def has_rudder(self) -> bool:
        return self.layout != "differential"

    @property
    def has_pair(self) -> bool:
        """Whether two motors can turn the boat."""
        return self.layout != "rudder"

    @property
    def can_pivot(self) -> bool:
        """Whether the boat turns on the spot."""
        return self.layout != "rudder"

    @property
    def least_radius_m(self) -> float:
        """The smallest turning radius: 0 on the spot."""
        return 0.0 if self.can_pivot else self.turn_radius_m


DIFFERENTIAL = DriveSetting()


DeadBand = Annotated[float, Meta(ge=0.0, le=0.6)]
Gain = Annotated[float, Meta(ge=0.2, le=1.0)]
Asymmetry = Annotated[float, Meta(ge=1.0, le=10.0)]


class Thrusters(Section, frozen=True):
    """Shares of full command. By default commands are passed unchanged.

    A dead band is the least command that gives thrust, per side, ahead and astern. The gain of the stronger
    side is below 1, so that both are equal. asymmetry: how many times more command the same thrust takes
    astern.
    """

    left_ahead: DeadBand = 0.0
    left_astern: DeadBand = 0.0
    right_ahead: DeadBand = 0.0
    right_astern: DeadBand = 0.0
    left_gain: Gain = 1.0
    right_gain: Gain = 1.0
    asymmetry: Asymmetry = 1.0


class Handling(Section, frozen=True):
    """Figures of the hull, measured on the water. Defaults: a hull of one metre with two thrusters."""

    top_speed_m_s: Annotated[float, Meta(ge=0.05, le=20.0)] = 3.0  # at full throttle; the pool boat: 0.07
    surge_time_s: Positive = 1.0  # delay from throttle to speed
    turn_rate_rad_s: Positive = 0.65  # at full steering under way
    yaw_time_s: Positive = 0.6  # delay from demanded heading to heading
    slip_m: NonNegative = 0.4  # outward slip in a turn, per turn rate
    turn_time_s: Positive = 0.8  # delay from steering to turn rate: Nomoto's T
    turn_accel_rad_s2: NonNegative = 0.0  # Nomoto's K/T of the hull that the gains are for; 0: not known
    motor_time_s: Positive = 0.15  # delay from command to thrust
    stop_m: NonNegative = 0.0  # from cruise speed, full astern in still water; 0: not measured


class Windage(Section, frozen=True):
    """What the wind does to the boat, for the planner; a ruler and a luggage scale tell. Docs: planner.md.

    Areas above the water, as seen from ahead and from the side. draught_m: with fin or rudder. pull_n: of all
    motors full ahead at the jetty. apart_m: from shaft to shaft. 0: not known.
    """

    frontal_area_m2: NonNegative = 0.0
    lateral_area_m2: NonNegative = 0.0
    length_m: Positive = 1.0
    draught_m: Positive = 0.1
    pull_n: NonNegative = 0.0
    apart_m: NonNegative = 0.3
