"""What a receiver's fixes are off by, per axis, by the class of their solution.

Positions err by white noise and a first-order Gauss-Markov process, which the filter has a state for.
Velocities of a receiver that smooths them err by coloured noise. What changes more slowly meets that as white
noise of the same spectral density, (1 + ρ) / (1 − ρ) times as large for errors of which ρ lasts until the
next (P. D. Groves, *Principles of GNSS, Inertial, and Multisensor Integrated Navigation Systems*, 2nd ed.
2013, sections 3.4.3 and 14.2.7): no state is needed.
"""

import math
from typing import Final

from msgspec import Struct

from companion.config.tuning import Estimation
from companion.core.readings import GnssFix

SIGMA_PER_HDOP_M: Final = 0.8  # for receivers that state no accuracy
MAST_M: Final = 0.03  # an antenna half a metre up, rolling by 3°
# Cameras and fixed solutions, which state a decimetre or less, state their scatter as a distance; so do
# carrier solutions, GPS_FIX_TYPE 5 and 6
STATES_SCATTER_M: Final = 0.1
_RTK_FLOAT: Final = 5
# Solutions by code state less than they are off by within a day, for what all satellites have in common does
# not show in their residuals. MAX-M10S data sheet: a CEP of 1.5 m, 1.27 m an axis, where it states 1.1 m
CODE_SHARE: Final = 1.15
# Of the code's error: beyond, the share that is white is learned. Its autocorrelation bends at one minute
# and goes on for several (D. L. Wilson, *Correlation of errors*, gpscorr.htm; D. Schumayer et al., Sensors
# 20(21) 6050, 2020). From 100 to 400 s errors of `benchmarks.estimation` differ by less than 5 %
CODE_WANDER_SHARE: Final = 0.98
CODE_WANDER_S: Final = 200.0
# Velocities at 5 Hz correlate by 0.8 to 0.9 (K. Borre, C. Tiberius, ION GPS 2000): 0.9 to 1.9 s
CODE_VELOCITY_S: Final = 1.0
VELOCITY_M_S: Final = 0.05  # Doppler noise of a common receiver
_LEAST_S: Final = 0.02  # between two fixes: a tick
# Share of the stated speed accuracy. Receivers state it with a wide margin: the velocities of six u-blox
# receivers at rest, which stated 0.19 to 4.5 m/s, were off by 0.03 to 0.13 of that.
SPEED_ACCURACY_SHARE: Final = 0.2


class FixError(Struct, frozen=True):
    """Variances per axis: of the position, white_m2 and wander_m2, coloured over wander_s; of the velocity,
    velocity_m2_s2, of which the share `lasts` is in the error of the next fix.
    """

    white_m2: float
    wander_m2: float
    wander_s: float
    velocity_m2_s2: float
    lasts: float = 0.0

    @property
    def density(self) -> float:
        """Of the velocity's noise, as a factor of what white noise of its variance has."""
        return (1.0 + self.lasts) / (1.0 - self.lasts)


def stated_m(fix: GnssFix) -> float:
    """The horizontal accuracy that the receiver states."""
    accuracy_m = fix.horizontal_accuracy_m
    return SIGMA_PER_HDOP_M * fix.hdop if accuracy_m is None else accuracy_m


def fix_error(fix: GnssFix, setting: Estimation, dt_s: float) -> FixError:
    """The errors of a fix that arrives dt_s after the one before."""
    stated = stated_m(fix)
    if fix.fix_type >= _RTK_FLOAT or stated <= STATES_SCATTER_M:
        share, time_s, variance, lasts = setting.wander_share, setting.wander_s, 0.5 * stated * stated, 0.0
    else:
        share, time_s, variance = CODE_WANDER_SHARE, CODE_WANDER_S, (CODE_SHARE * stated) ** 2
        lasts = math.exp(-max(dt_s, _LEAST_S) / CODE_VELOCITY_S)
    # Without a statement: a camera pose is a hundred times more accurate than GNSS; so is its velocity
    speed = max(VELOCITY_M_S, SPEED_ACCURACY_SHARE * (fix.speed_accuracy_m_s or 0.0))
    variance += MAST_M * MAST_M
    wander = share * share * variance
    return FixError(variance - wander, wander, time_s, speed * speed, lasts)
