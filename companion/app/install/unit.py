"""The text of the boat's unit."""

from pathlib import Path
from string import Template

FILES = Path(__file__).parent / "files"
PROGRAMS = Path("/opt/mavboat/.venv/bin")
CONFIG = Path("/etc/mavboat/boat.toml")


def unit_text(programs: Path = PROGRAMS, config: Path = CONFIG) -> str:
    """The unit for the programs of this folder and this configuration."""
    template = Template((FILES / "mavboat.service").read_text(encoding="utf-8"))
    return template.substitute(bin=programs, config=config)
