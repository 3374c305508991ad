"""The drive's settings: a table of a boat's file."""

from companion.config.section import NonNegative, Positive, Section, Share
from sitl.world.drive.propeller import PropellerSettings
from sitl.world.drive.rudder import RudderSettings


class BridgeSettings(Section, frozen=True):
    """One half of a dual PWM bridge, seen from its motor as a source with a drop that grows with the current.

    drop_v: what its switches lose as soon as current flows; resistance_ohm: what they lose more per ampere.
    An L298N's bipolar switches lose 1.8–3.2 V at 1 A and up to 4.9 V at 2 A (ST's data sheet, total drop
    V_CEsat): 1.4 V and 1.15 Ω is a typical one. A bridge of field-effect transistors has no drop and
    hundredths of an ohm.

    brake: what the bridge does between two pulses. With brake it keeps the motor short-circuited: the current
    flows on through one switch and a diode, so the motor sees the command's share of the voltage less the
    drop, nothing turns until that is more than none (the dead band), and a motor that turns faster is held
    back. Without, the bridge opens: current flows only during pulses, and a motor that turns faster coasts.
    """

    drop_v: NonNegative = 1.4
    resistance_ohm: NonNegative = 1.15
    brake: bool = True


class EscSettings(Section, frozen=True):
    """An electronic speed controller with reverse, seen from its brushless motor as a voltage source.

    Within dead_band of neutral it opens its switches, and the motor coasts. Beyond, the voltage grows evenly
    to the pack's. Blue Robotics' Basic ESC has ±25 µs of 400 (its data sheet), hobby controllers up to twice
    that.
    """

    dead_band: Share = 0.0625
    resistance_ohm: NonNegative = 0.01


class MotorSettings(Section, frozen=True):
    """A permanent-magnet motor: E = k ω, torque k I, both with the same k in V s/rad = N m/A.

    no_load_a is the current that its brushes, bearings and seal cost at any speed: below that it does not
    turn. churning is what gears and wet seals cost as the square of the speed, N m per (rad/s)². The
    inertia is that of rotor, shaft, propeller and the water which turns with it. Winding inductance is left
    out: the current settles within a millisecond.
    """

    back_emf_v_s: Positive
    resistance_ohm: Positive
    inertia_kg_m2: Positive
    no_load_a: NonNegative = 0.1
    churning: NonNegative = 0.0


class ThrusterSettings(Section, frozen=True):
    """Two thrusters, or one. apart_m: the distance between the two shafts; 0: one shaft, on the left channel.

    left_gain, right_gain: what each makes of a command, as a share of it; 1 for equal thrusters.

    esc takes the bridge's place. A brushless motor behind it is described as a permanent-magnet motor with
    the constant 60 / (2 π Kv) and the resistance between two terminals.
    """

    apart_m: NonNegative
    motor: MotorSettings
    propeller: PropellerSettings
    bridge: BridgeSettings = BridgeSettings()
    esc: EscSettings | None = None
    rudder: RudderSettings | None = None
    left_gain: Positive = 1.0
    right_gain: Positive = 1.0
