"""Configuration of the boat's behaviour: control, guidance, estimation, avoidance, fence and failsafes."""

import math
from typing import Annotated, Literal

from msgspec import Meta

from companion.config.section import NonNegative, Positive, Section, Share
from companion.core.modes import Mode


class Heading(Section, frozen=True):
    """Heading PID in the paper's form, Gc = Kp (1 + 1/(Ti s) + Td s), given as Kp, Ki = Kp/Ti, Kd = Kp Td.

    Input rad, output share of full differential thrust: kp is 1/rad, ki 1/(rad s), kd s/rad. The gains apply
    from cruise speed upwards; at rest they are multiplied by slow_gain, linear in between.

    Defaults, by pole placement (Fossen 2021, chapter 15) for the lake boat, T = 0.8 s, K = 0.6 rad/s:
    ω = √(K kp / T) = 1.6 rad/s, twice that of the path, 2 m/s over 3 m; ζ = (1 + K kd) / (2 ω T) = 1.2, so
    that a hull with 30 % less skeg does not swing.
    """

    kp: NonNegative = 3.75
    ki: NonNegative = 1.0
    kd: NonNegative = 3.75
    integral_band_rad: NonNegative = 0.15  # the integral is active within this error; 0: always
    max_steering: Share = 1.0
    slow_gain: Annotated[float, Meta(ge=0.2, le=5.0)] = 1.0  # 1: constant gains


class Speed(Section, frozen=True):
    """Speed loop: feed-forward throttle at cruise speed, then PI on the speed error.

    The default of kp closes the loop at (1 + 3.3 kp) / 3 s = 1.7 rad/s, with the lake boat's time constant of
    3 s. With 0.8, the motors' commands travel a tenth less (campaign calm_hands), but the boat turns round
    nearer to a shore that it finds late; with 2.0, the noise of GNSS velocities is passed to the motors.
    """

    cruise_m_s: Positive = 2.0
    cruise_throttle: Share = 0.6
    kp: NonNegative = 1.2  # share of full throttle per m/s
    ki: NonNegative = 0.2
    max_throttle: Share = 1.0


class MotorLimits(Section, frozen=True):
    """Limits of the gate, and the lifetime of a thrust command."""

    slew_per_s: Positive = 4.0  # full scale per second; reversal passes through zero
    deadband: Share = 0.0  # smaller commands are not sent: the propeller would only hum
    command_timeout_s: Positive = 0.5
    estimate_timeout_s: Positive = 3.0


class Guidance(Section, frozen=True):
    """Line of sight, corners and station keeping."""

    waypoint_radius_m: Positive = 2.0
    lookahead_m: Positive = 3.0
    accel_m_s2: Positive = 0.4  # deceleration for corners and stops
    corner_accel_m_s2: Positive = 0.8  # centripetal acceleration in corners
    min_speed_m_s: Positive = 0.4  # slowest speed with steerage way
    pivot_angle_rad: Annotated[float, Meta(gt=0.0, le=math.pi)] = 1.05  # beyond it, it turns on the spot
    station_radius_m: Positive = 1.5


class Estimation(Section, frozen=True):
    """Time constants and uncertainties. Those that scale with the boat are shares of its cruise speed."""

    gnss_timeout_s: Positive = 1.5  # silence after which the receiver is lost
    compass_timeout_s: Positive = 1.5
    dead_reckoning_s: NonNegative = 60.0  # longest dead reckoning
    lost_sigma_m: Positive = 10.0  # uncertainty at which the position is lost
    surge_time_s: Positive = 3.0  # response time of the hull to thrust, at cruise speed
    wander_s: Positive = 60.0  # time constant of the receiver's drift,
    wander_share: Share = 0.8  # and its share of the error; the rest is white
    compass_doubt_rad: Annotated[float, Meta(gt=0.0, le=math.pi)] = 0.035  # residual error after calibration
    compass_gate_rad: Annotated[float, Meta(gt=0.0, le=math.pi)] = 0.26  # largest difference from the gyro


class AvoidanceSetting(Section, frozen=True):
    """Obstacle detection and avoidance. Distances are from the boat's centre.

    enable: Rover's AVOID_ENABLE, a sum of 1 fence, 2 rangers; goes_round: Rover's OA_TYPE, 0 stops before
    obstacles, 1 goes around them. by_sight: where the speed is limited to what the boat can stop from within
    the water that its rangers have looked at: 0 nowhere, 1 everywhere, 2 near an obstacle that no plan knew,
    for water that is on the plan's map, 3 there and outside an uploaded inclusion fence.
    """

    enable: Annotated[int, Meta(ge=0, le=7)] = 3
    goes_round: bool = True
    by_sight: Annotated[int, Meta(ge=0, le=3)] = 3
    by_hand: bool = False  # stop before obstacles in manual modes, too
    margin_m: Positive = 1.0  # from the edge of obstacles
    vessel_margin_m: NonNegative = 5.0  # from the hull of a vessel with AIS, beside the error of its position
    lookahead_m: Positive = 6.0  # obstacles farther off are ignored
    beam_rad: Annotated[float, Meta(gt=0.0, le=math.pi)] = math.radians(15.0)  # of the boat's own ranger
    detour_m: NonNegative = 80.0  # longest detour
    retry_s: Positive = 30.0  # until the next attempt

    @property
    def avoids_obstacles(self) -> bool:
        """Whether the rangers are used."""
        return bool(self.enable & 2)


CIRCLE_KIND = 2  # of `kinds`: the circle around home
AREAS_KIND = 4  # of `kinds`: the uploaded areas


class FenceSetting(Section, frozen=True):
    """kinds is ArduPilot's FENCE_TYPE: the sum of 2 for the circle of radius_m around home and 4 for the
    uploaded polygons and circles. `failsafe.fence_action` is the action on a breach.
    """

    enabled: bool = True
    kinds: Annotated[int, Meta(ge=0, le=7)] = AREAS_KIND
    radius_m: Positive = 300.0
    margin_m: NonNegative = 2.0  # the boat stops this far inside; its way home keeps half as much again
    rally_includes_home: bool = True  # RTL may also go home if there are rally points


ActionNumber = Annotated[int, Meta(ge=0, le=6)]
ClearingNumber = Annotated[int, Meta(ge=0, le=7)]
MotorNumber = Annotated[int, Meta(ge=0, le=8)]
GroundNumber = Annotated[int, Meta(ge=0, le=9)]


class Failsafe(Section, frozen=True):
    """Thresholds and actions; `failsafe/table.py` lists all failsafes.

    Actions are Rover's FS_ACTION numbers: 0 report only, 1 RTL, 2 HOLD, 3 SMART_RTL or RTL, 4 SMART_RTL or
    HOLD, 5 disarm, 6 LOITER or HOLD; and the boat's own: 7 clear the propellers by pulses astern, 8 test the
    motors one by one and continue with those that work, 9 get off the shore.
    """

    gcs_enabled: bool = True
    gcs_timeout_s: Positive = 5.0
    action: ActionNumber = 6
    long_timeout_s: NonNegative = 120.0  # operator or planner lost for this long; 0: never
    long_action: ActionNumber = 1
    # transmitter or manual input lost: 0 off, 1 on, 2 not in AUTO
    rc_enabled: Annotated[int, Meta(ge=0, le=2)] = 1
    manual_timeout_s: Positive = 1.0  # lifetime of MANUAL_CONTROL and RC override
    rc_timeout_s: NonNegative = 1.5  # delay of the RC failsafe
    planner_timeout_s: NonNegative = 5.0  # 0: off
    planner_action: ActionNumber = 6
    battery_low_v: NonNegative = 10.2  # 0: off
    battery_low_s: Positive = 10.0
    battery_action: ActionNumber = 1
    battery_critical_v: NonNegative = 9.6  # 0: off
    battery_critical_action: ActionNumber = 1
    range_action: ActionNumber = 1
    range_margin: Annotated[float, Meta(ge=1.0, le=10.0)] = 1.5  # times the charge for the way home
    range_reserve: Share = 0.1  # of the capacity, never to be used
    fence_action: ActionNumber = 1  # outside the fence; LOITER goes to the nearest place inside
    position_action: ActionNumber = 6
    dead_reckoning_s: NonNegative = 300.0  # without a position, bow into the current, before HOLD
    heading_action: ActionNumber = 6  # without a heading the boat drifts
    gnss_action: ActionNumber = 0
    compass_action: ActionNumber = 0
    sonar_action: ActionNumber = 0
    sonar_timeout_s: Positive = 3.0
    steering_action: MotorNumber = 8
    motor_action: MotorNumber = 8
    stuck_action: ClearingNumber = 7
    aground_action: GroundNumber = 9
    min_depth_m: NonNegative = 1.0  # of the water, with a sounder: three times what it can measure; 0: off
    depth_action: ActionNumber = 3  # back over water that was deep enough; LOITER would stay in the shallows
    clearing_tries: Annotated[int, Meta(ge=1, le=10)] = 2
    headway_action: ActionNumber = 1
    capsize_rad: Annotated[float, Meta(ge=0.0, le=math.pi)] = math.radians(60.0)  # 0: off
    capsize_action: ActionNumber = 5
    leak_action: ActionNumber = 1
    max_temperature_c: NonNegative = 85.0  # of hull or computer; 0: off
    temperature_action: ActionNumber = 1
    overrun_action: ActionNumber = 6
    storage_action: ActionNumber = 0
    # mission interrupted by a power loss: 0 forget, 1 ask, 2 resume
    resume: Annotated[int, Meta(ge=0, le=2)] = 1


Pulse = Annotated[int, Meta(ge=800, le=2200)]
StickChannel = Annotated[int, Meta(ge=1, le=4)]
SwitchChannel = Annotated[int, Meta(ge=0, le=18)]


class RcChannel(Section, frozen=True):
    """A stick channel in µs of pulse width: end points, trim, and dead zone.

    A throttle without reverse has its trim at the minimum.
    """

    min_us: Pulse = 1000
    trim_us: Pulse = 1500
    max_us: Pulse = 2000
    dead_us: Annotated[int, Meta(ge=0, le=200)] = 30
    is_reversed: bool = False


class Rc(Section, frozen=True):
    """A receiver on a UART, and the transmitter's sticks and switches. Channels count from 1; 0: none.

    failsafe_us: a shorter throttle pulse means a lost transmitter; 0: never.
    """

    driver: Literal["crsf", "ibus", "sbus", "autopilot", "none"] = "none"
    port: str = "/dev/ttyAMA4"
    timeout_s: Positive = 0.5  # without a good frame the transmitter is lost
    failsafe_us: Annotated[int, Meta(ge=0, le=1100)] = 910
    steering_channel: StickChannel = 1
    throttle_channel: StickChannel = 3
    channel_1: RcChannel = RcChannel()
    channel_2: RcChannel = RcChannel()
    channel_3: RcChannel = RcChannel()
    channel_4: RcChannel = RcChannel()
    arm_channel: SwitchChannel = 0  # up arms, down disarms
    mode_channel: SwitchChannel = 0
    mode_1: Mode = Mode.MANUAL  # by Rover's number, for the six positions of the mode switch
    mode_2: Mode = Mode.HOLD
    mode_3: Mode = Mode.LOITER
    mode_4: Mode = Mode.AUTO
    mode_5: Mode = Mode.RTL
    mode_6: Mode = Mode.GUIDED

    @property
    def steering(self) -> RcChannel:
        return self.stick(self.steering_channel)

    @property
    def throttle(self) -> RcChannel:
        return self.stick(self.throttle_channel)

    @property
    def modes(self) -> tuple[Mode, ...]:
        """The modes of the switch's six positions."""
        return (self.mode_1, self.mode_2, self.mode_3, self.mode_4, self.mode_5, self.mode_6)

    def stick(self, number: int) -> RcChannel:
        return (self.channel_1, self.channel_2, self.channel_3, self.channel_4)[number - 1]
