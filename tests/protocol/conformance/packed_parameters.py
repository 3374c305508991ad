"""The packed parameter file that ArduPilot vehicles offer, read strictly.

After ArduPilot's public description of `@PARAM/param.pck`: a header of magic, count and total, then one entry
a parameter (type and flags, lengths of the common prefix and of the rest of the name, the rest, value,
default), with zero bytes between entries to keep them within blocks.
"""

import struct

_MAGIC, _MAGIC_WITH_DEFAULTS = 0x671B, 0x671C
_VALUES = {1: "<b", 2: "<h", 3: "<i", 4: "<f"}


def unpack(data: bytes) -> dict[str, float]:
    """Names and values.

    Raises:
        AssertionError: not such a file, or a count that is not the number of entries.
    """
    magic, count, total = struct.unpack_from("<HHH", data)
    assert magic in (_MAGIC, _MAGIC_WITH_DEFAULTS), f"magic {magic:#06x}"
    assert count == total, f"{count} of {total}"
    values: dict[str, float] = {}
    at, name = 6, ""
    while at < len(data):
        if data[at] == 0:
            at += 1
            continue
        kind, flags = data[at] & 0x0F, data[at] >> 4
        common, rest = data[at + 1] & 0x0F, (data[at + 1] >> 4) + 1
        name = name[:common] + data[at + 2 : at + 2 + rest].decode("ascii")
        at += 2 + rest
        code = _VALUES[kind]
        values[name] = float(struct.unpack_from(code, data, at)[0])
        at += struct.calcsize(code) * (2 if flags & 1 else 1)
    assert len(values) == count, f"{len(values)} entries, {count} announced"
    return values
