"""Scenarios: what they mean, how they are layered, and what a mistake in one says."""

from pathlib import Path

import pytest
import shapely

from companion.core.errors import ConfigError
from mission_tools.errors import MissionToolsError
from sitl.scenarios.layers import merge, parse_overrides
from sitl.scenarios.scenario import load_scenario

SCENARIOS = Path(__file__).parents[3] / "sitl" / "scenarios"
BOATS = Path(__file__).parents[3] / "sitl" / "boats"


def write(folder: Path, text: str) -> str:
    file = folder / "mine.toml"
    file.write_text("[origin]\nlat_deg = 50.0\nlon_deg = -1.2\n" + text, encoding="utf-8")
    return str(file)


def test_a_scenario_and_the_command_line_lie_over_the_boats_file(tmp_path: Path) -> None:
    file = write(tmp_path, "[sensors.gnss]\nrate_hz = 2.0\n[vehicle.heading]\nkp = 3.0\n")
    scenario = load_scenario(file, ["sensors.gnss.noise_m=0.5", "hull.mass_kg=9", "vehicle.heading.kd=0.2"])
    plain = load_scenario("open")
    assert (scenario.sensors.gnss.rate_hz, scenario.sensors.gnss.noise_m) == (2.0, 0.5)
    assert scenario.sensors.gnss.wander_m == plain.sensors.gnss.wander_m
    assert (scenario.hull.mass_kg, scenario.hull.length_m) == (9.0, plain.hull.length_m)
    assert (scenario.vehicle.heading.kp, scenario.vehicle.heading.kd) == (3.0, 0.2)
    assert scenario.vehicle.speed == plain.vehicle.speed


def test_a_boat_of_ones_own_is_found_beside_the_scenario(tmp_path: Path) -> None:
    heavy = (BOATS / "lake.toml").read_text(encoding="utf-8").replace("mass_kg = 8.0", "mass_kg = 80.0")
    (tmp_path / "heavy.toml").write_text(heavy, encoding="utf-8")
    assert load_scenario(write(tmp_path, '[boat]\nmodel = "heavy.toml"\n')).hull.mass_kg == 80.0


def test_a_map_alone_is_a_scenario_with_the_lake_boat_afloat() -> None:
    scenario = load_scenario(str(SCENARIOS / "maps" / "mill_pond.geojson"))
    assert scenario.hull == load_scenario("lake").hull
    assert scenario.chart.water.contains(shapely.Point(scenario.start.east_m, scenario.start.north_m))


def test_override_values_are_toml_or_else_words() -> None:
    tree = merge([parse_overrides(["a.b=1", "a.c=[1.5, 2]", "a.d=true", 'e="x=y"', "f=word"])])
    assert tree == {"a": {"b": 1, "c": [1.5, 2], "d": True}, "e": "x=y", "f": "word"}


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("[environment]\ncurent_m_s = 1.0\n", "mine.toml: environment.curent_m_s: no such setting"),
        ("[environment]\ncurrent_m_s = -1.0\n", "mine.toml: environment.current_m_s: Expected float >= 0.0"),
        ("[hull]\nbeam_m = 3.0\n", "beam_m must not exceed length_m"),
        (
            "[boat]\nmodel = 'canoe'\n",
            "mine.toml: boat.model: no boat 'canoe': expected one of catamaran, kit, lake, pool, rudder",
        ),
        ("nonsense = 1\n[boat]\n", "mine.toml: Object contains unknown field `nonsense` - at `$.origin`"),
        ("[bot]\nmodel = 'lake'\n", "mine.toml: bot: no such setting"),
        ("[boat\n", "mine.toml: not a TOML file"),
    ],
)
def test_a_mistake_names_file_and_key(tmp_path: Path, text: str, expected: str) -> None:
    file = write(tmp_path, text)
    with pytest.raises((ConfigError, MissionToolsError)) as caught:
        load_scenario(file)
    assert expected in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_mistake_on_the_command_line_or_in_the_boats_file_is_blamed_there(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=r"^--set: seed: Expected int, got str"):
        load_scenario("open", ["seed=x"])
    (tmp_path / "odd.toml").write_text(
        (BOATS / "pool.toml").read_text(encoding="utf-8").replace("beam_m", "width_m"), encoding="utf-8"
    )
    with pytest.raises(ConfigError, match=r"odd\.toml: hull\.width_m: no such setting"):
        load_scenario(write(tmp_path, '[boat]\nmodel = "odd.toml"\n'))


@pytest.mark.parametrize("override", ["seed", "=1", "a..b=1"])
def test_an_override_without_key_or_value_is_refused(override: str) -> None:
    with pytest.raises(ConfigError, match="expected KEY=VALUE"):
        load_scenario("open", [override])


def test_a_scenario_that_does_not_exist_lists_those_that_do() -> None:
    with pytest.raises(
        ConfigError, match="sea: no such scenario: expected one of bench_boat, lake, open, pool"
    ):
        load_scenario("sea")
    with pytest.raises(ConfigError, match=r"nowhere\.toml: cannot be read"):
        load_scenario("nowhere.toml")


def test_a_start_on_land_is_refused_and_says_where() -> None:
    with pytest.raises(
        ConfigError, match=r"pool\.toml: boat\.start: \[0\.56, 1\.27\] is not on the water \(Drum\)"
    ):
        load_scenario("pool", ["boat.start=[0.56, 1.27]"])
