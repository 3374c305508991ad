"""A winch by time and by pulses, tick by tick."""

import math

import pytest

from companion.config.boat_config import decode_config
from companion.config.payload import WinchPayload
from companion.payload.actions import MoveWinch, WinchMotion
from companion.payload.actuator import Winch
from sitl.world.payload import SimPayload

TICK_S = 0.02
WINCH = {"kind": "winch", "line_m": 5.0, "speed_m_s": 0.5, "pulse_m": 0.1, "stall_s": 2.0}


class Rig:
    def __init__(self, **counter: int) -> None:
        config = decode_config({"payload": [{**WINCH, **counter}]}, "test")
        self.sim, self.now_s = SimPayload(config), 100.0
        self.sim.step(self.now_s)
        self.motor = self.sim.outputs[0]
        (setting,) = config.payload
        assert isinstance(setting, WinchPayload)
        self.winch = Winch(setting, self.motor, self.sim.counters.get(0))

    @property
    def values(self) -> list[float]:
        return [one.value for one in self.motor.history]

    def move(self, motion: WinchMotion, length_m: float = 0.0, rate_m_s: float = 0.0) -> None:
        self.winch.move(MoveWinch(1, motion, length_m, rate_m_s), self.now_s)

    def run(self, seconds: float) -> float:
        """Seconds until the winch stops, at most these."""
        began_s = self.now_s
        while self.now_s < began_s + seconds and self.winch.is_moving:
            self.now_s += TICK_S
            self.sim.step(self.now_s)
            self.winch.tick(self.now_s)
        return self.now_s - began_s


def test_the_length_is_known_once_the_line_was_wound_in() -> None:
    rig = Rig()
    rig.move(WinchMotion.RETRACT)
    assert rig.run(60.0) == pytest.approx(10.0, abs=2 * TICK_S)  # it might have been out whole
    assert rig.values == [-1.0, 0.0]
    assert rig.winch.out_m == 0.0
    rig.move(WinchMotion.LENGTH, 4.0)
    rig.run(60.0)
    assert rig.winch.out_m == pytest.approx(4.0, abs=0.02)
    rig.move(WinchMotion.LENGTH, 4.0)
    assert rig.run(60.0) == pytest.approx(2.0, abs=2 * TICK_S)  # only one metre is left
    rig.move(WinchMotion.RETRACT)
    assert rig.run(60.0) == pytest.approx(10.0, abs=4 * TICK_S)
    rig.move(WinchMotion.LENGTH, -1.0)
    assert rig.run(60.0) == 0.0  # it is in


def test_without_pulses_it_stops_and_says_so() -> None:
    rig = Rig(count_pin=22)
    rig.move(WinchMotion.LENGTH, 2.0)
    rig.run(1.51)
    rig.sim.counters[0].is_stuck = True
    assert rig.run(60.0) == pytest.approx(2.0, abs=0.13)
    assert rig.values[-1] == 0.0
    assert rig.winch.stall_text == "no pulse for 2 s, stopped"
    rig.move(WinchMotion.LENGTH, 0.1)
    assert rig.winch.stall_text == ""


def test_a_reversal_rests_first_and_the_rest_is_not_counted() -> None:
    rig = Rig()
    rig.move(WinchMotion.LENGTH, 5.0)
    rig.run(1.0)
    rig.move(WinchMotion.LENGTH, -1.0)
    assert rig.values == [1.0, 0.0]
    rig.run(0.07)
    assert rig.values == [1.0, 0.0]
    assert rig.run(60.0) == pytest.approx(2.0 + 0.02, abs=3 * TICK_S)
    assert rig.values == [1.0, 0.0, -1.0, 0.0]


def test_a_motor_that_does_not_obey_leaves_the_length_unknown() -> None:
    rig = Rig()
    rig.winch.out_m = 0.0
    rig.move(WinchMotion.LENGTH, 4.0)
    rig.run(1.0)
    rig.motor.fault = "bus"
    rig.run(2.0)
    assert math.isnan(rig.winch.out_m)
