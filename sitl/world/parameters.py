"""Simulation parameters for faults, hull, wind and tide, with the names of ArduPilot where it has them."""

import math
from collections.abc import Callable
from functools import partial

from companion.config.parameters import ParameterHook, ParameterRow, ParameterType
from companion.core.geo import LatLon, LocalFrame
from sitl.world.environment.current import Current
from sitl.world.environment.settings import Environment
from sitl.world.environment.wind import Wind
from sitl.world.faults.catalogue import FaultSetting
from sitl.world.faults.injection import Injection
from sitl.world.faults.parts import LeakPart
from sitl.world.faults.schedule import Faults
from sitl.world.sensors.hull_sensor import SimHullSensor
from sitl.world.sensors.settings import HullSensorSettings

_MAG_KINDS = {1: "off", 2: "stuck"}
_RC_KINDS = {1: "off", 2: "wrong", 3: "stuck", 4: "garbage", 5: "failsafe"}  # the first two as in ArduPilot
_SIDES = ("motor_left", "motor_right")


def fault_hooks(faults: Faults, injection: Injection, frame: LocalFrame) -> list[ParameterHook]:
    """The parameters that begin and end faults."""

    def switch(what: str, kind: str | None, size: float | None = None, towards_deg: float = 0.0) -> None:
        if kind is not None:
            faults.begin(FaultSetting(what=what, kind=kind, size=size, towards_deg=towards_deg))
        elif what in faults.active:
            faults.end(what)

    def enable(value: float) -> None:
        injection.is_enabled = value == 1.0

    def gnss(kind: str, value: float) -> None:
        switch("gnss", kind if value else None)

    glitch_deg = [0.0, 0.0]

    def glitch(axis: int, value: float) -> None:
        glitch_deg[axis] = value
        lat_deg = min(max(frame.origin.lat_deg + glitch_deg[0], -90.0), 90.0)
        lon_deg = min(max(frame.origin.lon_deg + glitch_deg[1], -180.0), 180.0)
        jump = frame.to_local(LatLon(lat_deg, lon_deg))
        jump_m, towards_deg = math.hypot(*jump), math.degrees(math.atan2(jump.east_m, jump.north_m))
        switch("gnss", "wrong" if jump_m else None, jump_m, towards_deg)

    engine = {"mask": 0.0, "gain": 1.0}

    def fail_engines(name: str, value: float) -> None:
        engine[name] = value
        for bit, side in enumerate(_SIDES):
            is_hit = bool(int(engine["mask"]) >> bit & 1) and engine["gain"] != 1.0
            switch(side, "slow" if is_hit else None, engine["gain"])

    hooks = [
        _hook("SYS_FAILURE_EN", "Faults by MAV_CMD_INJECT_FAILURE: 0 refused, 1 taken", enable, 1.0),
        _hook("SIM_GPS_DISABLE", "1 silences the receiver", partial(gnss, "off")),
        _hook("SIM_GPS_JAM", "1 jams the receiver", partial(gnss, "jammed")),
        _hook("SIM_GPS_GLITCH_X", "Jump of the position north", partial(glitch, 0), low=-1.0, unit="deg"),
        _hook("SIM_GPS_GLITCH_Y", "Jump of the position east", partial(glitch, 1), low=-1.0, unit="deg"),
        _hook(
            "SIM_MAG1_FAIL",
            "Compass: 1 silent, 2 stuck",
            lambda value: switch("compass", _MAG_KINDS.get(int(value))),
            high=2.0,
        ),
        _hook(
            "SIM_ENGINE_FAIL",
            "Motors that SIM_ENGINE_MUL is for: 1 left, 2 right",
            partial(fail_engines, "mask"),
            high=3.0,
        ),
        _hook(
            "SIM_ENGINE_MUL",
            "Gain of their commands: 0 dead, -1 reversed",
            partial(fail_engines, "gain"),
            1.0,
            low=-1.0,
        ),
    ]
    if "rc" in faults.parts:
        text = "RC receiver: 1 silent, 2 preset pulses, 3 stuck, 4 garbage, 5 failsafe"
        hooks.append(
            _hook("SIM_RC_FAIL", text, lambda value: switch("rc", _RC_KINDS.get(int(value))), high=5.0)
        )
    return hooks


def hull_hooks(hull: SimHullSensor, leak: LeakPart, settings: HullSensorSettings) -> list[ParameterHook]:
    """Water and temperature in the hull. ArduPilot has no names for these."""
    return [
        _hook("SIM_LEAK", "1: water at the probe in the hull", leak.set_wet),
        _hook(
            "SIM_HULL_TEMP", "Temperature in the hull", hull.set_temperature, settings.temperature_c,
            low=-40.0, high=150.0, unit="degC",
        ),
    ]  # fmt: skip


def wind_hooks(environment: Environment, wind: Wind) -> list[ParameterHook]:
    """Mean wind and its direction. Gusts stay as far above the mean as in the scenario."""
    gust_m_s = max(0.0, environment.gust_m_s - environment.wind_m_s)
    mean = {"m_s": environment.wind_m_s, "from_deg": environment.wind_from_deg}

    def change(name: str, value: float) -> None:
        mean[name] = value
        peak_m_s = mean["m_s"] + gust_m_s if gust_m_s else 0.0
        wind.set_wind(mean["m_s"], math.radians(mean["from_deg"]), peak_m_s)

    return _speed_and_direction(
        "SIM_WIND_SPD", "Mean wind at the hull", "SIM_WIND_DIR", "wind", change, mean, 60.0
    )


def tide_hooks(current: Current, on_change: Callable[[], None]) -> list[ParameterHook]:
    """A uniform stream on top of the scenario's current; its direction is where it comes from."""
    stream = {"m_s": 0.0, "from_deg": 0.0}

    def change(name: str, value: float) -> None:
        stream[name] = value
        speed_m_s, from_rad = stream["m_s"], math.radians(stream["from_deg"])
        current.stream(-speed_m_s * math.cos(from_rad), -speed_m_s * math.sin(from_rad))
        on_change()

    return _speed_and_direction(
        "SIM_TIDE_SPEED", "Tidal stream", "SIM_TIDE_DIR", "tidal stream", change, stream, 10.0
    )


def _speed_and_direction(
    speed_name: str,
    speed_text: str,
    direction_name: str,
    what: str,
    change: Callable[[str, float], None],
    default: dict[str, float],
    highest_m_s: float,
) -> list[ParameterHook]:
    return [
        _hook(
            speed_name, speed_text, partial(change, "m_s"), default["m_s"], high=highest_m_s, unit="m/s",
            kind=ParameterType.REAL32,
        ),
        _hook(
            direction_name, f"Where the {what} comes from", partial(change, "from_deg"), default["from_deg"],
            low=-360.0, high=360.0, unit="deg",
        ),
    ]  # fmt: skip


def _hook(
    name: str,
    text: str,
    on_change: Callable[[float], None],
    default: float = 0.0,
    *,
    low: float = 0.0,
    high: float = 1.0,
    unit: str = "",
    kind: ParameterType | None = None,
) -> ParameterHook:
    """kind: by default INT32 for choices, from 0 on, and REAL32 for quantities of either sign."""
    kind = kind or (ParameterType.INT32 if low == 0.0 else ParameterType.REAL32)
    row = ParameterRow(name, kind, text, default=default, low=low, high=high, unit=unit)
    return ParameterHook(row, on_change)
