"""The simulated battery pack."""

import pytest
from hypothesis import given
from hypothesis import strategies as st
from msgspec import structs

from sitl.scenarios.scenario import load_scenario
from sitl.world.pack import CELL_V, CLIFF, BatterySettings, Pack

KIT = load_scenario("bench_boat").battery


def test_a_full_pack_at_rest_shows_its_cells_less_the_idle_drop() -> None:
    pack = Pack(BatterySettings(cells=3, resistance_ohm=0.1, idle_a=0.5))
    assert pack.voltage_v == pytest.approx(3 * 4.20 - 0.05)
    assert pack.current_a == 0.5


def test_an_hour_at_one_ampere_takes_a_thousand_milliampere_hours() -> None:
    pack = Pack(BatterySettings(capacity_mah=2000.0, idle_a=0.25, resistance_ohm=0.0))
    for _ in range(3600):
        pack.step(0.75, 1.0)
    assert pack.used_mah == pytest.approx(1000.0)
    assert pack.charge == pytest.approx(0.5)
    assert pack.voltage_v == pytest.approx(3 * CELL_V[5])


def test_load_sags_the_voltage_by_current_times_resistance() -> None:
    pack = Pack(BatterySettings(charge=0.5, resistance_ohm=0.08, idle_a=0.0))
    pack.step(0.0, 0.0)
    at_rest = pack.voltage_v
    pack.step(10.0, 0.0)
    assert at_rest - pack.voltage_v == pytest.approx(0.8)


def test_the_voltage_of_a_cell_is_linear_between_tenths_of_its_charge() -> None:
    for charge, cell_v in (
        (0.95, 0.5 * (4.08 + 4.20)),
        (0.15, 0.5 * (3.61 + 3.69)),
        (0.04, 3.27 + 0.4 * 0.34),
    ):
        pack = Pack(BatterySettings(cells=2, charge=charge, resistance_ohm=0.0))
        assert pack.voltage_v == pytest.approx(2.0 * cell_v)


def test_the_motors_see_the_mean_of_the_last_two_voltages() -> None:
    pack = Pack(BatterySettings(charge=0.5, resistance_ohm=0.1, idle_a=0.0))
    at_rest = pack.voltage_v
    pack.step(10.0, 0.0)
    assert pack.supply_v == pytest.approx(at_rest - 0.5)


def test_an_almost_empty_pack_sags_three_times_as_much() -> None:
    def sag_v(charge: float) -> float:
        pack = Pack(BatterySettings(charge=charge, resistance_ohm=0.08, idle_a=0.0))
        at_rest = pack.voltage_v
        pack.step(5.0, 0.0)
        return at_rest - pack.voltage_v

    assert sag_v(0.2) == pytest.approx(0.4)
    assert sag_v(1e-9) == pytest.approx(1.2)
    assert sag_v(0.0) == pytest.approx(1.2)


def test_a_pack_that_is_drawn_below_empty_falls_off_a_cliff_and_takes_the_computer_along() -> None:
    settings = BatterySettings(capacity_mah=1000.0, charge=0.0, idle_a=1.0, resistance_ohm=0.0)
    pack = Pack(settings)
    assert pack.voltage_v == pytest.approx(3 * CELL_V[0])
    assert pack.voltage_v > settings.brownout_v
    for _ in range(round(0.5 * CLIFF * 3600.0)):
        pack.step(0.0, 1.0)
    assert pack.voltage_v == pytest.approx(1.5 * CELL_V[0], rel=0.01)
    assert pack.voltage_v < settings.brownout_v
    for _ in range(3600):
        pack.step(0.0, 1.0)
    assert (pack.charge, pack.voltage_v) == (0.0, 0.0)
    assert pack.used_mah == pytest.approx(1000.0 * (1.0 + CLIFF))


@given(charges=st.tuples(st.floats(0.0, 1.0), st.floats(0.0, 1.0)))
def test_less_charge_never_shows_more_voltage(charges: tuple[float, float]) -> None:
    low, high = (Pack(BatterySettings(charge=charge)).voltage_v for charge in sorted(charges))
    assert low <= high


@pytest.mark.parametrize(
    ("times", "least_s", "most_s"), [(1.35, 0.75, 600.0), (2.0, 0.15, 5.0), (3.5, 0.08, 0.5)]
)
def test_the_fuse_opens_when_a_blade_fuse_does(times: float, least_s: float, most_s: float) -> None:
    # ISO 8820-3, operating time of blade fuses
    pack = Pack(structs.replace(KIT, idle_a=0.0, capacity_mah=50000.0))
    seconds = 0.0
    while pack.voltage_v > 0.0:
        pack.step(times * (KIT.fuse_a or 0.0), 0.02)
        seconds += 0.02
    assert least_s < seconds < most_s
