"""What stations see of the pack: the charge left must not follow the voltage of the moment."""

import itertools
import random

import pytest
from boat_rig import DENIED, FAILED, OK, FakeBattery, Rig

from companion.config.boat_config import BatteryPack
from companion.core.readings import BatteryReading
from companion.core.state import STOPPED, MotorCommand
from companion.mavlink.dialect import dialect
from companion.sensors.fuel_gauge import FuelGauge, _loads
from sitl.world.pack import BatterySettings, Pack

RESET = dialect.MAV_CMD_BATTERY_RESET
REJECTED_FOR_NOW = 1
REST, FULL, TURN, CRUISE = (0.0, 0.0), (0.8, 0.8), (0.2, 0.9), (0.5, 0.45)


def stop_and_go(time_s: float) -> MotorCommand:
    """A minute of rest, full speed, a hard turn and cruising, again and again."""
    phase_s = time_s % 60.0
    left, right = REST if phase_s < 10 else FULL if phase_s < 30 else TURN if phase_s < 40 else CRUISE
    return MotorCommand(left, right)


class Voyage:
    """What the gauge says over 25 minutes of it, ten times a second, and what the pack truly has."""

    def __init__(self, *, ohm: float, exponent: float, has_current: bool, seed: int = 20261122) -> None:
        print(f"seed {seed}")  # noqa: T201
        noise, pack = random.Random(seed), Pack(BatterySettings(resistance_ohm=ohm))
        gauge, battery = FuelGauge(), BatteryPack()
        self.shown: list[int] = []
        self.true: list[float] = []
        for number in range(15_000):
            time_s = 0.1 * number
            command = stop_and_go(time_s)
            pack.step(5.0 * (abs(command.left) ** exponent + abs(command.right) ** exponent), 0.1)
            voltage_v = pack.voltage_v + noise.gauss(0.0, 0.02)
            current_a = pack.current_a + noise.gauss(0.0, 0.05) if has_current else None
            gauge.update(BatteryReading(time_s, voltage_v, current_a), battery, command)
            self.shown.append(gauge.percent)
            self.true.append(100.0 * pack.charge)

    @property
    def steps(self) -> list[int]:
        """Every change of what is shown."""
        return [b - a for a, b in itertools.pairwise(self.shown) if a != b]


# exponent: of the current over the command, from stalled to free
@pytest.mark.parametrize(
    ("exponent", "ohm", "has_current", "least", "most"),
    [
        (1.0, 0.03, True, -2.0, 2.0), (3.0, 0.1, True, -4.0, 4.0),
        (1.0, 0.1, False, -17.0, 2.0), (3.0, 0.03, False, -17.0, 2.0),
    ],
)  # fmt: skip
def test_the_charge_shown_only_falls_by_single_percents_and_is_never_much_too_high(
    exponent: float, ohm: float, has_current: bool, least: float, most: float
) -> None:
    voyage = Voyage(ohm=ohm, exponent=exponent, has_current=has_current)
    assert set(voyage.steps) == {-1}
    assert len(voyage.steps) <= 101
    assert all(least <= a - b <= most for a, b in zip(voyage.shown, voyage.true, strict=True))


def test_relaxation_after_a_load_does_not_show_but_another_pack_does() -> None:
    gauge, battery = FuelGauge(), BatteryPack()
    for number in range(200):
        gauge.update(BatteryReading(0.1 * number, 11.4), battery, STOPPED)
    before = gauge.percent
    for number in range(200, 3000):
        gauge.update(BatteryReading(0.1 * number, 11.45), battery, STOPPED)
    assert gauge.percent == before
    for number in range(3000, 9000):
        gauge.update(BatteryReading(0.1 * number, 12.6), battery, STOPPED)
    assert gauge.percent == pytest.approx(95, abs=1)


# A pack that is changed without a restart


def low_pack() -> tuple[Rig, FakeBattery]:
    battery = FakeBattery(10.0)
    rig = Rig(battery=battery)
    rig.run(15.0)
    assert "Failsafe: Battery low: 10.0 V" in rig.peer.texts
    return rig, battery


def is_low(rig: Rig) -> bool:
    return rig.boat.vehicle.failsafes.pack_is_low


def test_a_changed_pack_is_full_and_its_failsafe_is_over() -> None:
    rig, battery = low_pack()
    battery.voltage_v = 12.4
    rig.run(2.0)
    assert is_low(rig)
    assert rig.ask(RESET, 1.0, 100.0) == OK
    assert "Battery set to 100 %" in rig.peer.texts
    assert not is_low(rig)
    rig.run(15.0)
    assert rig.boat.sensors.gauge.percent in (99, 100)
    assert rig.boat.sensors.consumed_mah < 10.0
    assert not is_low(rig)
    assert rig.peer.said("BATTERY_STATUS")[-1].charge_state == dialect.MAV_BATTERY_CHARGE_STATE_OK


@pytest.mark.parametrize(
    ("params", "result"),
    [((1.0, 101.0), DENIED), ((1.0, -1.0), DENIED), ((1.0, float("nan")), DENIED), ((-1.0, 50.0), DENIED),
     ((2.0, 100.0), FAILED), ((0.0, 100.0), FAILED), ((255.0, 50.0), OK)],
)  # fmt: skip
def test_a_reset_says_which_pack_and_how_much(params: tuple[float, ...], result: int) -> None:
    rig = Rig().ready()
    assert rig.ask(RESET, *params) == result


def test_the_load_of_a_command_is_linear_and_cubic() -> None:
    assert _loads(MotorCommand(-0.5, 0.2)) == pytest.approx((0.7, 0.133))


def used(amperes: float, seconds: float, gauge: FuelGauge, began_s: float = 0.0) -> float | None:
    """Draw a current from a full pack; the time left that the gauge says."""
    for tenths in range(round(10.0 * seconds) + 1):
        time_s = began_s + 0.1 * tenths
        gauge.update(BatteryReading(time_s, 12.6, amperes), BatteryPack(capacity_mah=2000.0), STOPPED)
    return gauge.time_left_s


def test_the_time_left_follows_another_draw_within_minutes() -> None:
    gauge = FuelGauge()
    used(1.0, 10.0, gauge)
    first_s = used(4.0, 60.0, gauge, 10.0)  # mean 1 + 3 (1 − 1/e) = 2.9 A
    assert first_s == pytest.approx((2000.0 - 69.4) * 3.6 / 2.896, rel=0.01)
    assert used(4.0, 240.0, gauge, 70.0) == pytest.approx((2000.0 - 336.0) * 3.6 / 3.98, rel=0.01)


def test_without_a_current_or_a_draw_the_time_left_is_unknown() -> None:
    gauge = FuelGauge()
    gauge.update(BatteryReading(0.0, 12.6, None), BatteryPack(), STOPPED)
    assert gauge.time_left_s is None
    assert used(-1.0, 1.0, FuelGauge()) is None, "charging"
