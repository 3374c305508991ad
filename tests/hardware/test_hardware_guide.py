"""The hardware page and the example configuration say the same as the code."""

import re
from pathlib import Path

import pytest
from gpiozero.pins.mock import MockFactory

from companion.config.boat_config import BoatConfig, load_config
from companion.links.port_url import parse_port_url

ROOT = Path(__file__).parents[2]
GUIDE = (ROOT / "docs" / "hardware.md").read_text(encoding="utf-8")
EXAMPLE = ROOT / "examples" / "configs" / "boat.toml"
ROWS = re.findall(r"^\| (\d+) \| (\d+) \| ([^|]+) \|([^|]*)\|$", GUIDE, re.MULTILINE)


def value_at(config: BoatConfig, path: str) -> object:
    value: object = config
    for name in path.split("."):
        value = getattr(value, name)
    return value


def test_the_wiring_table_names_every_pin_of_the_configuration() -> None:
    keys = {key for row in ROWS for key in re.findall(r"`(parts\.[a-z_.]+)`", row[3])}
    motors = {
        f"parts.motors.{side}_{pin}"
        for side in ("left", "right")
        for pin in ("forward", "backward", "enable")
    }
    assert keys == motors | {
        "parts.sonar.trigger",
        "parts.sonar.echo",
        "parts.sonar.servo",
        "parts.gnss.port",
    }


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


def test_no_pin_is_used_twice() -> None:
    assert len({row[0] for row in ROWS}) == len(ROWS) == 14


def test_the_example_is_a_whole_boat_with_links_that_can_be_read() -> None:
    config = load_config(EXAMPLE)
    parts = config.parts
    drivers = [part.driver for part in (parts.motors, parts.gnss, parts.compass, parts.sonar, parts.battery)]
    assert "none" not in drivers
    urls = [link if isinstance(link, str) else link.url for link in config.links]
    assert [parse_port_url(url).kind for url in urls] == ["udpout", "tcpin"]
    assert config.storage.folder
