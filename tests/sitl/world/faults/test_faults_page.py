"""docs/faults.md says what the emulator can do, all of it, and as it is."""

import re
import tomllib
from pathlib import Path

import pytest

from sitl.scenarios.layers import Layer
from sitl.scenarios.scenario import load_scenario
from sitl.world.faults.catalogue import CATALOGUE
from sitl.world.world import World

PAGE = (Path(__file__).parents[4] / "docs" / "faults.md").read_text(encoding="utf-8")


def test_the_table_of_faults_is_the_catalogue() -> None:
    rows = re.findall(r"^\| `(\w+)` \| `(\w+)` \| ([-\d.]*) \| (.*) \|$", PAGE, re.MULTILINE)
    assert rows == [
        (what, kind, f"{effect.size:g}" if "size" in effect.text else "", effect.text)
        for what, kinds in CATALOGUE.items()
        for kind, effect in kinds.items()
    ]


def test_every_parameter_that_the_emulator_brings_along_is_on_the_page() -> None:
    world = World(load_scenario("open", ["sensors.rc.fitted=true"]))
    brought = {hook.row.name for hook in world.hardware.parameter_hooks}
    assert brought == set(re.findall(r"`((?:SIM|SYS)_\w+)`", PAGE))


@pytest.mark.parametrize("block", re.findall(r"^```toml\n(.*?)^```$", PAGE, re.MULTILINE | re.DOTALL))
def test_every_example_is_a_scenario(block: str) -> None:
    tree = tomllib.loads(block)
    scenario = load_scenario("open", over=[Layer("docs/faults.md", tree)])
    (key,) = tree
    assert getattr(scenario, key) != getattr(load_scenario("open"), key)


def test_the_parameters_are_limited_to_what_makes_sense() -> None:
    world = World(load_scenario("open", ["sensors.rc.fitted=true", "sensors.hull.fitted=true"]))
    rows = {hook.row.name: hook.row for hook in world.hardware.parameter_hooks}
    switch = (0.0, 1.0, 0.0)
    assert {name: (row.low, row.high, row.default) for name, row in rows.items()} == {
        "SYS_FAILURE_EN": (0.0, 1.0, 1.0),
        "SIM_GPS_DISABLE": switch,
        "SIM_GPS_JAM": switch,
        "SIM_GPS_GLITCH_X": (-1.0, 1.0, 0.0),
        "SIM_GPS_GLITCH_Y": (-1.0, 1.0, 0.0),
        "SIM_MAG1_FAIL": (0.0, 2.0, 0.0),
        "SIM_ENGINE_FAIL": (0.0, 3.0, 0.0),
        "SIM_ENGINE_MUL": (-1.0, 1.0, 1.0),
        "SIM_RC_FAIL": (0.0, 5.0, 0.0),
        "SIM_LEAK": switch,
        "SIM_HULL_TEMP": (-40.0, 150.0, 40.0),
        "SIM_WIND_SPD": (0.0, 60.0, 0.0),
        "SIM_WIND_DIR": (-360.0, 360.0, 270.0),
        "SIM_TIDE_SPEED": (0.0, 10.0, 0.0),
        "SIM_TIDE_DIR": (-360.0, 360.0, 0.0),
    }
