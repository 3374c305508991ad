"""Fills in the bytes of frames.json with pymavlink's own packer: `python tests/vectors/make_frames.py`.

A row of the table is a frame and what it says, or a flawed frame and how it is to be counted. To add a
message, write its row without `hex`. The table drives the decode test, the encode test and the fuzz seeds.
"""

import json
import math
from pathlib import Path
from typing import Any

from pymavlink.dialects.v20 import all as dialect

PATH = Path(__file__).parent / "frames.json"


def pack(row: dict[str, Any], sequence: int) -> bytes:
    """The row's frame, from station 255/190, with a signature of a well-known key where it asks for one."""
    packer = dialect.MAVLink(None, srcSystem=255, srcComponent=190)
    packer.seq = sequence
    packer.signing.secret_key = bytes(range(32))
    packer.signing.timestamp = (1 << 40) + sequence
    packer.signing.sign_outgoing = row["signed"]
    fields = {name: from_json(value) for name, value in row["fields"].items()}
    message = getattr(dialect, f"MAVLink_{row['message'].lower()}_message")(**fields)
    frame: bytes = message.pack(packer, force_mavlink1=row["version"] == 1)
    return frame


def from_json(value: object) -> object:
    """null is NaN, a text is bytes."""
    return math.nan if value is None else value.encode() if isinstance(value, str) else value


def main() -> None:
    """Rewrite the table."""
    rows = json.loads(PATH.read_text(encoding="utf-8"))
    for sequence, row in enumerate(rows):
        if "message" in row:
            row["sequence"] = sequence
            row["hex"] = pack(row, sequence).hex()
    PATH.write_text("[\n" + ",\n".join(json.dumps(row) for row in rows) + "\n]\n", encoding="utf-8")


if __name__ == "__main__":
    main()
