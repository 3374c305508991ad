"""Faults by parameter, while the boat sails: ArduPilot's SIM_* names where the meaning is the same."""

import math
from collections.abc import Callable

from companion.config.parameters import ParameterHook, ParameterRow, ParameterType
from companion.core.geo import LatLon, LocalFrame
from sitl.world.faults.catalogue import FaultSetting
from sitl.world.faults.injection import Injection
from sitl.world.faults.schedule import Faults

_MAG_KINDS = {1: "off", 2: "stuck"}
_RC_KINDS = {1: "off", 2: "wrong", 3: "stuck", 4: "garbage", 5: "failsafe"}  # the first two as in ArduPilot
_SIDES = ("motor_left", "motor_right")


class FaultParameters:
    """What the parameters have been set to, and what that means for the parts."""

    def __init__(self, faults: Faults, injection: Injection, frame: LocalFrame) -> None:
        self._faults = faults
        self._injection = injection
        self._frame = frame
        self._glitch_lat_deg = self._glitch_lon_deg = 0.0
        self._engine_mask, self._engine_gain = 0, 1.0
        parameter_hooks = (
            _hook(
                "SYS_FAILURE_EN", "Faults by MAV_CMD_INJECT_FAILURE: 0 refused, 1 taken", self._enable, 1.0
            ),
            _hook("SIM_GPS_DISABLE", "1 silences the receiver", self._disable_gnss),
            _hook("SIM_GPS_JAM", "1 jams the receiver", self._jam),
            _hook("SIM_GPS_GLITCH_X", "Jump of the position north", self._glitch_north, low=-1.0, unit="deg"),
            _hook("SIM_GPS_GLITCH_Y", "Jump of the position east", self._glitch_east, low=-1.0, unit="deg"),
            _hook("SIM_MAG1_FAIL", "Compass: 1 silent, 2 stuck", self._fail_compass, high=2.0),
            _hook(
                "SIM_ENGINE_FAIL", "Motors that SIM_ENGINE_MUL is for: 1 left, 2 right", self._fail, high=3.0
            ),
            _hook(
                "SIM_ENGINE_MUL", "Gain of their commands: 0 dead, -1 reversed", self._weaken, 1.0, low=-1.0
            ),
        )
        text = "RC receiver: 1 silent, 2 preset pulses, 3 stuck, 4 garbage, 5 failsafe"
        rc = (_hook("SIM_RC_FAIL", text, self._fail_rc, high=5.0),) if "rc" in faults.parts else ()
        self.parameter_hooks = parameter_hooks + rc

    def _set(self, what: str, kind: str | None, size: float | None = None, towards_deg: float = 0.0) -> None:
        if kind is not None:
            self._faults.begin(FaultSetting(what=what, kind=kind, size=size, towards_deg=towards_deg))
        elif what in self._faults.active:
            self._faults.end(what)

    def _enable(self, value: float) -> None:
        self._injection.is_enabled = value == 1.0

    def _disable_gnss(self, value: float) -> None:
        self._set("gnss", "off" if value else None)

    def _jam(self, value: float) -> None:
        self._set("gnss", "jammed" if value else None)

    def _glitch_north(self, value: float) -> None:
        self._glitch_lat_deg = value
        self._glitch()

    def _glitch_east(self, value: float) -> None:
        self._glitch_lon_deg = value
        self._glitch()

    def _glitch(self) -> None:
        origin = self._frame.origin
        lat_deg = min(max(origin.lat_deg + self._glitch_lat_deg, -90.0), 90.0)
        lon_deg = min(max(origin.lon_deg + self._glitch_lon_deg, -180.0), 180.0)
        there = self._frame.to_local(LatLon(lat_deg, lon_deg))
        off_m, towards_deg = math.hypot(*there), math.degrees(math.atan2(there.east_m, there.north_m))
        self._set("gnss", "wrong" if off_m else None, off_m, towards_deg)

    def _fail_compass(self, value: float) -> None:
        self._set("compass", _MAG_KINDS.get(int(value)))

    def _fail_rc(self, value: float) -> None:
        self._set("rc", _RC_KINDS.get(int(value)))

    def _fail(self, value: float) -> None:
        self._engine_mask = int(value)
        self._drive()

    def _weaken(self, value: float) -> None:
        self._engine_gain = value
        self._drive()

    def _drive(self) -> None:
        for bit, side in enumerate(_SIDES):
            is_hit = bool(self._engine_mask >> bit & 1) and self._engine_gain != 1.0
            self._set(side, "slow" if is_hit else None, self._engine_gain)


def _hook(
    name: str,
    text: str,
    turn: Callable[[float], None],
    default: float = 0.0,
    *,
    low: float = 0.0,
    high: float = 1.0,
    unit: str = "",
) -> ParameterHook:
    kind = (
        ParameterType.INT32 if low == 0.0 else ParameterType.REAL32
    )  # choices, and quantities of either sign
    return ParameterHook(ParameterRow(name, kind, text, default=default, low=low, high=high, unit=unit), turn)
