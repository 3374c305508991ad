"""One thruster: a bridge, a brushed motor and a propeller, from command to thrust and current.

With d the command's share, V the pack's voltage, k the motor's constant, ω the shaft's speed, R the
resistance of winding and bridge and V_b the bridge's drop, the current averaged over a pulse is

    bridge that brakes:     I = (d V − V_b − k ω) / R, none between there and −V_b, braking beyond
    bridge that opens:      I = d (V − V_b − k ω) / R, never negative

and the shaft follows

    J ω̇ = k I − Q(ω, u_a) − Q_c ω|ω| − Q_f sgn ω            Q_f = k I_0, the friction that also holds it at
    rest

which is stepped by the linearly implicit Euler rule (Rosenbrock's first): one evaluation a step, its steady
state exact, stable whatever the step. From the pack comes I only while the pulse lasts: d I. So the pack's
power d V I covers what bridge, winding and friction turn to heat, and the propeller's Q ω.

Commands are shares of full drive, −1..1, positive ahead.
"""

from companion.section import Positive, Section
from sitl.drive.bridge import BridgeParameters
from sitl.drive.motor import MotorParameters
from sitl.drive.propeller import Propeller, PropellerParameters

_AT_REST_RAD_S = 1e-6
_WEED_TORQUE = 1.1  # of the stall torque, for a propeller that is wholly overgrown


class ThrusterParameters(Section, frozen=True):
    """A pair of equal thrusters; apart_m is the distance between the two shafts."""

    apart_m: Positive
    motor: MotorParameters
    propeller: PropellerParameters
    bridge: BridgeParameters = BridgeParameters()


class Thruster:
    """Its state is the shaft's speed_rad_s; thrust_n, the propeller's torque_nm and current_a follow from it.

    current_a is drawn from the pack. Faults reach it by gain, a factor on the command (0 is dead, −1 wired
    the wrong way round), and by weed, 0..1, which drags on the propeller until the motor stalls, and takes
    thrust. grip is the share of the propeller that is in the water.
    """

    __slots__ = (
        "_back_emf", "_brake", "_churning", "_drop_v", "_friction_nm", "_inertia", "_propeller",
        "_resistance", "current_a", "gain", "grip", "motor_a", "speed_rad_s", "thrust_n", "torque_nm",
        "weed",
    )  # fmt: skip

    def __init__(self, parameters: ThrusterParameters) -> None:
        """Start at rest."""
        motor, bridge = parameters.motor, parameters.bridge
        self._back_emf, self._inertia, self._churning = (
            motor.back_emf_v_s,
            motor.inertia_kg_m2,
            motor.churning,
        )
        self._resistance = motor.resistance_ohm + bridge.resistance_ohm
        self._drop_v, self._brake = bridge.drop_v, bridge.brake
        self._friction_nm = motor.back_emf_v_s * motor.no_load_a
        self._propeller = Propeller(parameters.propeller)
        self.speed_rad_s = self.thrust_n = self.torque_nm = self.motor_a = self.current_a = 0.0
        self.gain = self.grip = 1.0
        self.weed = 0.0

    def step(self, command: float, supply_v: float, advance_m_s: float, dt_s: float) -> None:
        """Hold a command for dt_s, at the pack's voltage, in water that comes from ahead with advance_m_s."""
        speed = self.speed_rad_s
        if command == 0.0 and -_AT_REST_RAD_S < speed < _AT_REST_RAD_S:
            self.speed_rad_s = self.thrust_n = self.torque_nm = self.motor_a = self.current_a = 0.0
            return
        back_emf, propeller = self._back_emf, self._propeller
        drive = command * self.gain
        share = drive if drive >= 0.0 else -drive
        emf = back_emf * speed if drive >= 0.0 else -back_emf * speed  # in the drive's direction

        # Current in the drive's direction, and how it falls as the shaft speeds up.
        conductance = 1.0 / self._resistance
        if self._brake:
            over_v = share * supply_v - emf
            if over_v > self._drop_v:
                over_v -= self._drop_v
            elif over_v < -self._drop_v:
                over_v += self._drop_v
            else:
                over_v = conductance = 0.0
        else:
            over_v = supply_v - self._drop_v - emf
            conductance *= share
            if over_v < 0.0:
                over_v = conductance = 0.0
        current = over_v * conductance

        # The shaft.
        size = speed if speed >= 0.0 else -speed
        nn, nu = propeller.torque_nn * self.grip, propeller.torque_nu * self.grip * advance_m_s
        nn += self._churning
        load_nm = nn * speed * size - nu * size
        slope = back_emf * back_emf * conductance + 2.0 * nn * size - (nu if speed >= 0.0 else -nu)
        lag = dt_s / (self._inertia + dt_s * (slope if slope > 0.0 else 0.0))
        speed += lag * (back_emf * (current if drive >= 0.0 else -current) - load_nm)
        hold = self._friction_nm
        if self.weed > 0.0:
            hold += self.weed * _WEED_TORQUE * back_emf * supply_v / self._resistance
        hold *= lag
        if speed > hold:
            speed -= hold
        elif speed < -hold:
            speed += hold
        else:
            speed = 0.0
        self.speed_rad_s = speed

        # What comes of it.
        size = speed if speed >= 0.0 else -speed
        thrust = propeller.thrust_nn * speed * size
        if speed < 0.0:
            thrust *= propeller.astern_share
        self.thrust_n = (thrust - propeller.thrust_nu * size * advance_m_s) * self.grip * (1.0 - self.weed)
        self.torque_nm = self.grip * size * (propeller.torque_nn * speed - propeller.torque_nu * advance_m_s)
        self.motor_a = current
        self.current_a = share * current if current > 0.0 else 0.0


class Thrusters:
    """The pair."""

    __slots__ = ("_arm_m", "left", "right")

    def __init__(self, parameters: ThrusterParameters) -> None:
        """Start at rest."""
        self._arm_m = 0.5 * parameters.apart_m
        self.left = Thruster(parameters)
        self.right = Thruster(parameters)

    def step(
        self, left: float, right: float, supply_v: float, surge_m_s: float, yaw_rate_rad_s: float, dt_s: float
    ) -> tuple[float, float]:
        """Hold two commands for dt_s on a hull in motion; the force ahead and the clockwise moment."""
        arm_m = self._arm_m
        turn_m_s = arm_m * yaw_rate_rad_s  # clockwise, the port shaft goes faster ahead
        self.left.step(left, supply_v, surge_m_s + turn_m_s, dt_s)
        self.right.step(right, supply_v, surge_m_s - turn_m_s, dt_s)
        port, starboard = self.left.thrust_n, self.right.thrust_n
        return port + starboard, (port - starboard) * arm_m

    @property
    def current_a(self) -> float:
        """What both motors draw from the pack."""
        return self.left.current_a + self.right.current_a
