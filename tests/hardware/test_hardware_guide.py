"""The hardware page and the example configuration say the same as the code."""

import math
import re
import tomllib
import typing
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from gpiozero.pins.mock import MockFactory
from pictures.wiring_table import wiring_rows

from companion.app.needs import pins_in_use
from companion.config.actuators import PulseOutputSetting
from companion.config.boat_config import BoatConfig, decode_config, load_config
from companion.config.section import Section
from companion.config.sensors import ProbePart
from companion.config.tuning import Rc

ROOT = Path(__file__).parents[2]
GUIDE = (ROOT / "docs" / "hardware.md").read_text(encoding="utf-8")
EXAMPLE = ROOT / "examples" / "configs" / "boat.toml"
ROWS = wiring_rows(GUIDE)

OTHER_ROWS = re.findall(
    r"^\| `?(\w+)`? \| GPIO (\d+) \(pin (\d+)\) \| ([^|]+) \| `([a-z_.]+)`(?: = (\d+))? \|$",
    GUIDE,
    re.MULTILINE,
)

PARTS_TABLE = re.findall(
    r"^\| \[([^]]+)\]\(#([^)]+)\) \| `([a-z.]+) = \"(\w+)\"` \| ([^|]+) \| ([^|]+) \|$", GUIDE, re.MULTILINE
)


def choices(section: type[Section], path: str) -> Iterator[tuple[str, str]]:
    """The drivers that a section can name, with their key; inertial sensors and outputs of signals, too."""
    hints = typing.get_type_hints(section)
    for name in {"driver", "imu", "output", "telemetry"} & hints.keys():
        for value in re.findall(r"'(\w+)'", str(hints[name])):
            if value != "none":
                yield f"{path}{name}", value


def all_choices() -> Iterator[tuple[str, str]]:
    for name in BoatConfig().parts.__struct_fields__:
        if isinstance(part := getattr(BoatConfig().parts, name), Section):
            yield from choices(type(part), f"parts.{name}.")
    yield from choices(Rc, "rc.")
    yield from choices(ProbePart, "probe.")
    yield from choices(PulseOutputSetting, "")


def test_each_driver_has_a_row_in_the_table_of_parts_and_each_row_its_driver() -> None:
    assert {(key, driver) for _, _, key, driver, _, _ in PARTS_TABLE} == set(all_choices())


@pytest.mark.parametrize("row", PARTS_TABLE, ids=lambda row: row[3])
def test_a_row_of_the_table_of_parts_leads_to_its_section_and_says_how_it_was_tested(
    row: tuple[str, ...],
) -> None:
    headings = [
        re.sub(r"[^a-z0-9 -]", "", one.lower()) for one in re.findall(r"^#+ (.+)$", GUIDE, re.MULTILINE)
    ]
    assert row[1] in {heading.replace(" ", "-") for heading in headings}
    assert row[5].strip()
    assert all(len(cell.split()) <= 15 for cell in row)


def value_at(config: BoatConfig, path: str) -> object:
    value: object = config
    for name in path.split("."):
        value = getattr(value, name)
    return value


@pytest.mark.parametrize("row", ROWS, ids=lambda row: f"GPIO{row[0]}")
def test_a_row_of_the_wiring_table_is_true(row: tuple[str, str, str, str]) -> None:
    bcm, header, _, key = row
    ((_, pin),) = MockFactory(revision="c03111").board_info.find_pin(f"GPIO{bcm}")
    assert pin.number == int(header)
    path = re.search(r"`(parts\.(?:motors|sonar)[a-z_.]+)`", key)
    if path and "default −1" not in key:
        assert value_at(BoatConfig(), path[1]) == int(bcm)
    if path:
        assert value_at(load_config(EXAMPLE), path[1]) == int(bcm)


def layout_of(driver: str) -> str:
    return "rudder" if driver == "rudder" else "differential"


def config_of(driver: str) -> BoatConfig:
    """The boat of the other motors' rows: the driver, and the values that the rows give."""
    tree: dict[str, Any] = {"drive": {"layout": layout_of(driver)}, "parts": {"motors": {"driver": driver}}}
    if driver == "rudder":
        tree["parts"] = {"motors": {"driver": "esc"}, "rudder": {"driver": "servo"}}
    for row in OTHER_ROWS:
        if row[0] == driver and row[5]:
            tree["parts"]["motors"][row[4].removeprefix("parts.motors.")] = int(row[5])
    return decode_config(tree, driver)


@pytest.mark.parametrize("row", OTHER_ROWS, ids=lambda row: f"{row[0]} GPIO {row[1]}")
def test_a_row_of_the_other_motors_is_true(row: tuple[str, ...]) -> None:
    driver, bcm, header, _, key, _ = row
    ((_, pin),) = MockFactory(revision="c03111").board_info.find_pin(f"GPIO{bcm}")
    assert pin.number == int(header)
    assert value_at(config_of(driver), key) == int(bcm)


@pytest.mark.parametrize("driver", ["bts7960", "tb6612", "drv8833", "esc", "rudder"])
def test_the_other_motors_rows_are_all_outputs_of_that_driver(driver: str) -> None:
    rows = {(row[4], f"GPIO {row[1]}") for row in OTHER_ROWS if row[0] == driver}
    used = {
        (use.key if "_" in use.key else f"{use.key}.pin", f"GPIO {use.pin}")
        for use in pins_in_use(config_of(driver))
        if driver != "rudder" or "rudder" in use.key
    }
    assert rows == used


@pytest.mark.parametrize(
    "text", re.findall(r"```toml\n(\[parts\.(?:motors|rudder)\].*?)```", GUIDE, re.DOTALL)
)
def test_a_table_of_the_page_can_be_read(text: str) -> None:
    config = decode_config(tomllib.loads(text), "page")
    assert config.parts.motors.driver in ("esc", "vesc") or config.parts.rudder.driver == "servo"


def test_the_lidars_table_of_the_page_hides_the_mast_and_leaves_the_bow() -> None:
    (text,) = re.findall(r"```toml\n(\[parts\.lidar\].*?)```", GUIDE, re.DOTALL)
    lidar = decode_config(tomllib.loads(text), "page").parts.lidar
    blind = [degrees for degrees in range(0, 360, 5) if lidar.is_blind(math.radians(degrees), 0.0)]
    assert blind == [175, 180, 185]
