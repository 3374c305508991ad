"""The bridge between pack and motor: an L298N, or one with less to lose."""

from companion.config.section import NonNegative, Section


class BridgeParameters(Section, frozen=True):
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
