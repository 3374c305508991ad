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
