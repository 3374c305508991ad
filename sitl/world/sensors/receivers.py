"""Classes of satellite receivers, and the settings of one.

Errors of positions are a sum, per axis, of white noise and two first-order Gauss-Markov processes: X. Niu et
al., *Using Allan variance to analyze the error characteristics of GNSS positioning*, GPS Solutions 18, 2014,
find these terms in recorded positions; D. Schumayer et al., *Comparison of enhanced noise model performance
based on analysis of civilian GPS data*, Sensors 20(21) 6050, 2020, find the process in those of stationary
single-frequency receivers. The faster one is the receiver's filter and its surroundings: the autocorrelation
of twenty days of a consumer receiver bends at one minute (D. L. Wilson, *Correlation of errors*,
gpscorr.htm). The slower one is what ionosphere, orbits and the geometry of the satellites leave.

Data sheets state the radius that holds half of 24 h of positions (CEP, 1.18 deviations of an axis) and half
of the errors of speed (0.67 deviations). Of u-blox: NEO-M8 (UBX-15031086) 2.5 m, with SBAS 2.0 m; MAX-M10S
(UBX-20035208) 1.5 m; ZED-F9P (UBX-17051259) 1.5 m, with SBAS 1.0 m, RTK fixed 0.01 m + 1 ppm; all 0.05 m/s,
which is 0.074 m/s a deviation.

Velocities come from the carrier's tracking loop and the receiver's filter: at 5 Hz, neighbours correlate by
up to 0.8 to 0.9 (K. Borre, C. Tiberius, *Time series analysis of GPS observables*, ION GPS 2000), which is
a time constant of 0.9 to 1.9 s.
"""

from collections.abc import Mapping
from typing import Annotated, Final, Literal

from msgspec import Meta

from companion.config.section import NonNegative, Positive, Section

ErrorM = Annotated[float, Meta(ge=0.0, le=1e5)]  # of a position, which stays on the globe
Receiver = Literal["standalone", "sbas", "rtk"]


class GnssSettings(Section, frozen=True):
    """A satellite receiver, or what stands in for one. Deviations are per axis.

    receiver: its class, which sets the keys of RECEIVERS; a scenario, or `--set`, may change single ones.
    noise_m is white; wander_m and slow_m are the Gauss-Markov processes, with the time constants wander_s and
    slow_s. So is the noise of the velocity, with velocity_noise_s; 0: white. Near the shore, trees and walls
    add reflections: a further wander of deviation multipath_m at the water's edge, falling to nothing
    multipath_reach_m away.

    A fix carries the receiver's time of day and arrives latency_s to latency_s + jitter_s later, evenly
    distributed; the boat's own driver code dates it. The accuracy that it states follows from fix_type and
    HDOP (`sitl.world.sensors.gnss`), not from its errors.
    """

    receiver: Receiver = "standalone"
    rate_hz: Positive = 5.0
    noise_m: ErrorM = 0.10  # of the code after the receiver's filter: centimetres to a decimetre
    wander_m: ErrorM = 0.6
    wander_s: Positive = 60.0
    slow_m: ErrorM = 1.2  # 1.3 m in all: a CEP of 1.6 m, as a MAX-M10S, better than a NEO-M8
    slow_s: Positive = 400.0
    velocity_noise_m_s: NonNegative = 0.08
    velocity_noise_s: NonNegative = 1.0
    multipath_m: ErrorM = 0.0
    multipath_reach_m: Positive = 4.0
    latency_s: NonNegative = 0.15
    jitter_s: NonNegative = 0.15
    fix_type: Annotated[int, Meta(ge=0, le=6)] = 3  # GPS_FIX_TYPE
    satellites: Annotated[int, Meta(ge=0, le=60)] = 12
    hdop: Positive = 0.9
    speed_accuracy_m_s: NonNegative = 0.0  # as reported; 0: not reported


# "sbas", also a multi-band receiver by itself: 0.6 m in all, a CEP of 0.7 m, between the data sheet's 1.0 m
# and the 0.4 m of the FAA's WAAS performance reports (95 % within 0.7 to 1 m). "rtk": a float solution of
# decimetres, which states 0.3 m; a fixed one has centimetres and fix_type 6.
RECEIVERS: Final[Mapping[str, GnssSettings]] = {
    one.receiver: one
    for one in (
        GnssSettings(),
        GnssSettings(
            receiver="sbas", noise_m=0.08, wander_m=0.3, slow_m=0.5, fix_type=4, satellites=16, hdop=0.8
        ),
        GnssSettings(
            receiver="rtk", wander_m=0.15, wander_s=30.0, slow_m=0.0, velocity_noise_s=0.0, fix_type=5,
            satellites=20, hdop=0.9,
        ),
    )
}  # fmt: skip
OF_CLASS: Final = (  # the keys that a class sets
    "noise_m", "wander_m", "wander_s", "slow_m", "slow_s", "velocity_noise_m_s", "velocity_noise_s",
    "fix_type", "satellites", "hdop",
)  # fmt: skip
