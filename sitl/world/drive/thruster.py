"""One thruster: a bridge or speed controller, a motor and a propeller, from command to thrust and current.

With d the command's share, V the pack's voltage, k the motor's constant, ω the shaft's speed, R the
resistance of winding and bridge and V_b the bridge's drop, the current averaged over a pulse is

    bridge that brakes:     I = (d V − V_b − k ω) / R, none between there and −V_b, braking beyond
    bridge that opens:      I = d (V − V_b − k ω) / R, never negative
    speed controller:       as a bridge that brakes, without a drop; none within its dead band

and the shaft follows

    J ω̇ = k I − Q(ω, u_a) − Q_c ω|ω| − Q_f sgn ω            Q_f = k I_0, the friction that also holds it at
    rest

which is stepped by the linearly implicit Euler rule (Rosenbrock's first): one evaluation a step, its steady
state exact, stable whatever the step. From the pack comes I only while the pulse lasts: d I. So the pack's
power d V I covers what bridge, winding and friction turn to heat, and the propeller's Q ω.

Commands are shares of full drive, −1..1, positive ahead.
"""

from sitl.world.drive.propeller import Propeller
from sitl.world.drive.settings import BridgeSettings, ThrusterSettings

_WEED_TORQUE = 1.1  # of the stall torque, for a propeller that is wholly overgrown


class Thruster:
    """Its state is the shaft's speed_rad_s; thrust_n, motor_a and current_a follow from it.

    motor_a flows in the motor, in the drive's direction; current_a is drawn from the pack. Faults reach it
    by gain, a factor on the command (0 is dead, −1 wired the wrong way round), and by weed, 0..1, which
    drags on the propeller until the motor stalls, and takes thrust. grip is the share of the propeller that
    is in the water.
    """

    def __init__(self, parameters: ThrusterSettings) -> None:
        motor, bridge, esc = parameters.motor, parameters.bridge, parameters.esc
        self._dead_band = 0.0
        if esc is not None:
            bridge = BridgeSettings(drop_v=0.0, resistance_ohm=esc.resistance_ohm)
            self._dead_band = esc.dead_band
        conductance = 1.0 / (motor.resistance_ohm + bridge.resistance_ohm)
        self._brake, self._propeller = bridge.brake, Propeller(parameters.propeller)
        self._friction_nm = motor.back_emf_v_s * motor.no_load_a
        self._stall_nm_per_v = motor.back_emf_v_s * conductance
        self._constants = (
            motor.back_emf_v_s, conductance, bridge.drop_v, motor.inertia_kg_m2, motor.churning,
            self._propeller.torque_nn, self._propeller.torque_nu,
        )  # fmt: skip
        self.speed_rad_s = self.thrust_n = self.motor_a = self.current_a = 0.0
        self.gain = self.grip = 1.0
        self.weed = 0.0

    def step(self, command: float, supply_v: float, advance_m_s: float, dt_s: float) -> None:
        """Hold a command for dt_s, at the pack's voltage, in water that comes from ahead with advance_m_s."""
        speed, share, water_m_s = self.speed_rad_s, self._driven(command), advance_m_s
        if share == 0.0 and speed == 0.0:
            self.motor_a = self.current_a = 0.0
            return
        astern = share < 0.0
        if astern:  # mirrored, so that the drive is positive below
            speed, share, water_m_s = -speed, -share, -advance_m_s
        back_emf, conductance, drop_v, inertia, churning, torque_nn, torque_nu = self._constants
        grip = self.grip

        # The current, and how its torque falls as the shaft speeds up.
        if self._brake and (share > 0.0 or self._dead_band == 0.0):
            over_v = share * supply_v - back_emf * speed
            if over_v > drop_v:
                over_v -= drop_v
            elif over_v < -drop_v:
                over_v += drop_v
            else:
                over_v = conductance = 0.0
        else:
            over_v = supply_v - drop_v - back_emf * speed
            conductance *= share
            if over_v < 0.0:
                over_v = conductance = 0.0
        current = over_v * conductance

        # The shaft.
        size = speed if speed >= 0.0 else -speed
        torque_nn = torque_nn * grip + churning
        torque_nu *= grip * water_m_s
        slope = back_emf * back_emf * conductance + 2.0 * torque_nn * size
        slope -= torque_nu if speed >= 0.0 else -torque_nu
        lag = dt_s / (inertia + dt_s * slope) if slope > 0.0 else dt_s / inertia
        speed += lag * (back_emf * current - (torque_nn * speed - torque_nu) * size)
        hold = self._friction_nm
        if self.weed > 0.0:
            hold += self.weed * _WEED_TORQUE * self._stall_nm_per_v * supply_v
        hold *= lag
        if speed > hold:
            speed -= hold
        elif speed < -hold:
            speed += hold
        else:
            speed = 0.0

        # Resulting thrust and current.
        self.motor_a = current
        self.current_a = share * current if current > 0.0 else 0.0
        self.speed_rad_s = speed = -speed if astern else speed
        propeller = self._propeller
        if speed >= 0.0:
            thrust_n = speed * (propeller.thrust_nn * speed - propeller.thrust_nu * advance_m_s)
        else:
            thrust_n = speed * (propeller.thrust_nu * advance_m_s - propeller.astern_nn * speed)
        self.thrust_n = thrust_n * grip * (1.0 - self.weed)

    def _driven(self, command: float) -> float:
        """The share of the pack's voltage for a command."""
        share = command * self.gain
        if self._dead_band == 0.0:
            return share
        beyond = max(abs(share) - self._dead_band, 0.0) / (1.0 - self._dead_band)
        return beyond if share > 0.0 else -beyond


class Thrusters:
    """The pair, or the left one alone on the centre line."""

    def __init__(self, parameters: ThrusterSettings) -> None:
        self._arm_m = 0.5 * parameters.apart_m
        self._has_right = parameters.apart_m > 0.0
        self._left_gain, self._right_gain = parameters.left_gain, parameters.right_gain
        self._depth_m, self._tip_m = parameters.propeller.depth_m, 0.5 * parameters.propeller.diameter_m
        self.left = Thruster(parameters)
        self.right = Thruster(parameters)

    def step(
        self, left: float, right: float, supply_v: float, surge_m_s: float, yaw_rate_rad_s: float, dt_s: float
    ) -> tuple[float, float]:
        """Hold two commands for dt_s on a hull in motion; the force ahead and the clockwise moment."""
        arm_m = self._arm_m
        turn_m_s = arm_m * yaw_rate_rad_s  # clockwise, the port shaft goes faster ahead
        self.left.step(left * self._left_gain, supply_v, surge_m_s + turn_m_s, dt_s)
        self.right.step(
            right * self._right_gain if self._has_right else 0.0, supply_v, surge_m_s - turn_m_s, dt_s
        )
        port, starboard = self.left.thrust_n, self.right.thrust_n
        return port + starboard, (port - starboard) * arm_m

    @property
    def current_a(self) -> float:
        """What both motors draw from the pack."""
        return self.left.current_a + self.right.current_a

    def set_immersion(self, above_m: float) -> None:
        """Set the water level above the shafts, relative to rest. Near the surface the propellers ventilate.

        The share of thrust that is left falls from 1 at a depth of 1.3 radii to 0 where the disc is out of
        the water, about as K. Minsaas, O. Faltinsen and B. Persson measured (*On the importance of added
        resistance, propeller immersion and propeller ventilation for large ships in a seaway*, PRADS 1983).
        """
        share = (self._depth_m + above_m + self._tip_m) / (2.3 * self._tip_m)
        self.left.grip = self.right.grip = 0.0 if share < 0.0 else min(share, 1.0)
