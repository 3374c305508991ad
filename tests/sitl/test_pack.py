"""The simulated battery pack and the current in the water."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sitl.battery import CELL_V, BatteryParameters, Pack
from sitl.environment import Environment


def test_a_full_pack_at_rest_shows_its_cells_less_the_idle_drop() -> None:
    pack = Pack(BatteryParameters(cells=3, resistance_ohm=0.1, idle_a=0.5))
    assert pack.voltage_v == pytest.approx(3 * 4.20 - 0.05)
    assert pack.current_a == 0.5


def test_an_hour_at_one_ampere_takes_a_thousand_milliampere_hours() -> None:
    pack = Pack(BatteryParameters(capacity_mah=2000.0, idle_a=0.25, resistance_ohm=0.0))
    for _ in range(3600):
        pack.step(0.75, 1.0)
    assert pack.used_mah == pytest.approx(1000.0)
    assert pack.charge == pytest.approx(0.5)
    assert pack.voltage_v == pytest.approx(3 * CELL_V[5])


def test_load_sags_the_voltage_by_current_times_resistance() -> None:
    pack = Pack(BatteryParameters(charge=0.5, resistance_ohm=0.08, idle_a=0.0))
    pack.step(0.0, 0.0)
    at_rest = pack.voltage_v
    pack.step(10.0, 0.0)
    assert at_rest - pack.voltage_v == pytest.approx(0.8)


def test_an_empty_pack_stays_empty() -> None:
    pack = Pack(BatteryParameters(capacity_mah=10.0, idle_a=1.0, resistance_ohm=0.0))
    for _ in range(100):
        pack.step(0.0, 1.0)
    assert pack.charge == 0.0
    assert pack.voltage_v == pytest.approx(3 * CELL_V[0])


@given(charges=st.tuples(st.floats(0.0, 1.0), st.floats(0.0, 1.0)))
def test_less_charge_never_shows_more_voltage(charges: tuple[float, float]) -> None:
    low, high = (Pack(BatteryParameters(charge=charge)).voltage_v for charge in sorted(charges))
    assert low <= high


@pytest.mark.parametrize(
    ("to_deg", "north", "east"), [(0.0, 0.5, 0.0), (90.0, 0.0, 0.5), (180.0, -0.5, 0.0), (270.0, 0.0, -0.5)]
)
def test_the_current_flows_to_where_it_is_said_to_flow(to_deg: float, north: float, east: float) -> None:
    water = Environment(current_m_s=0.5, current_to_deg=to_deg)
    assert water.current_north_m_s == pytest.approx(north, abs=1e-12)
    assert water.current_east_m_s == pytest.approx(east, abs=1e-12)
