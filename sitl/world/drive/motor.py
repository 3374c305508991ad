"""The brushed DC motor, with what its shaft drags along."""

from companion.config.section import NonNegative, Positive, Section


class MotorParameters(Section, frozen=True):
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
