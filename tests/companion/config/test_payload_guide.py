"""The examples of docs/payload.md are accepted as they stand."""

import re
import shlex
from pathlib import Path

import pytest
from boat_rig import scenario

from companion.config.boat_config import decode_config
from companion.core.toml_text import parse_toml

GUIDE = (Path(__file__).parents[3] / "docs/payload.md").read_text(encoding="utf-8")
BLOCKS = [
    "\n".join(line.removeprefix("    ") for line in block.splitlines())
    for block in re.findall(r"(?:^    .*\n|^\n(?=    ))+", GUIDE, re.MULTILINE)
]


@pytest.mark.parametrize("block", [one for one in BLOCKS if one.lstrip().startswith("[")])
def test_an_example_of_the_configuration_is_valid(block: str) -> None:
    tree = parse_toml(block)
    config = decode_config(tree, "docs/payload.md")
    assert len(config.payload) == len(tree.get("payload", ()))
    assert config.camera.is_fitted is ("camera" in tree)


def test_the_command_of_the_first_paragraph_is_valid() -> None:
    (line,) = [one.strip() for one in BLOCKS if one.strip().startswith("boat-sitl")]
    program, command, option, setting = shlex.split(line)
    assert (program, command, option) == ("boat-sitl", "serve", "--set")
    assert scenario("open", setting).vehicle.payload[0].name == "bait"
