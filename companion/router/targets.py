"""Target of a frame, read from its bytes without unpacking."""

from companion.mavlink.address import ALL, Address
from companion.mavlink.dialect import dialect
from companion.mavlink.framing import Frame
from companion.mavlink.layout import LAYOUTS

EVERYBODY = Address(ALL, ALL)
_NOWHERE = 255  # beyond every field: reads as 0, like a truncated MAVLink 2 field


def _places() -> dict[int, tuple[int, int]]:
    """Offsets of target system and component in the payload, for all messages with a target."""
    places: dict[int, tuple[int, int]] = {}
    for message_id, layout in LAYOUTS.items():
        # in a payload of 0, 1, 2 …, a byte's value is its offset
        counted = layout.unpack(bytes(range(layout.size)))
        system = getattr(counted, "target_system", None)
        if system is not None:
            places[message_id] = system, getattr(counted, "target_component", _NOWHERE)
    # MANUAL_CONTROL has its target in another field
    steered = LAYOUTS[dialect.MAVLINK_MSG_ID_MANUAL_CONTROL]
    places[steered.message_id] = steered.unpack(bytes(range(steered.size))).target, _NOWHERE
    return places


_PLACES = _places()


def target_of(frame: Frame) -> Address:
    """Target system and component, 0 for all; a message without a target is for all."""
    places = _PLACES.get(frame.message_id)
    if places is None:
        return EVERYBODY
    system_at, component_at = places
    payload = frame.payload
    length = len(payload)
    if system_at >= length:
        return EVERYBODY if component_at >= length else Address(ALL, payload[component_at])
    return Address(payload[system_at], payload[component_at] if component_at < length else ALL)
