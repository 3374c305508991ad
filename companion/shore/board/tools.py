"""What the page may do on this computer, by the options of the program."""

import asyncio
from collections.abc import Sequence
from dataclasses import dataclass, field

from companion.shore.board.config_check import PROGRAM
from companion.shore.board.config_file import ConfigFile
from companion.shore.board.update_file import UpdateFolder
from companion.shore.board.wifi import Wifi


@dataclass(frozen=True)
class BoardTools:
    """None: this program does not run on the boat, or has no option for it. busy: one thing at a time."""

    config: ConfigFile | None = None
    wifi: Wifi | None = None
    update: UpdateFolder | None = None
    check: Sequence[str] = PROGRAM
    busy: asyncio.Lock = field(default_factory=asyncio.Lock)
