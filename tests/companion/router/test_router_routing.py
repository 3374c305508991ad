"""Where frames go: rules of the MAVLink guide, repeats, reboots, floods of addresses, downloads."""

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from companion.mavlink.address import Address
from companion.mavlink.codec import Encoder
from companion.mavlink.dialect import Message, dialect
from companion.mavlink.finder import FrameFinder
from companion.mavlink.framing import Frame
from companion.mavlink.layout import LAYOUTS
from companion.router.router import NOWHERE, DuplicateFilter, Router
from companion.router.routes import EVERYBODY, EXPIRY_S, MAX_HEARD, target_of

OWN = Address(1, 1)
GCS, CAMERA, OTHER = Address(255, 190), Address(1, 100), Address(2, 1)
BEAT = dialect.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3)


class Wire:
    """Frames of any sender, numbered as each would."""

    def __init__(self) -> None:
        self._encoders: dict[Address, Encoder] = {}

    def frame(self, sender: Address, message: Message = BEAT) -> Frame:
        encoder = self._encoders.setdefault(sender, Encoder(sender))
        (frame,) = FrameFinder(datagram=True).feed(encoder.encode(message))
        return frame


@pytest.fixture
def wire() -> Wire:
    return Wire()


def router_with(*heard: tuple[int, Address], links: int = 4) -> Router:
    router, wire = Router(OWN), Wire()
    for channel in range(1, links + 1):
        router.open(channel)
    for channel, address in heard:
        router.route(channel, wire.frame(address), 0.0)
    return router


def command(target: Address) -> Message:
    message: Message = dialect.MAVLink_command_long_message(*target, 400, 0, 1, 0, 0, 0, 0, 0, 0)
    return message


@pytest.mark.parametrize(
    ("message", "is_ours", "channels"),
    [
        (BEAT, True, (2, 3, 4)),  # for everybody: everywhere but back
        (command(OWN), True, ()),  # for the boat alone
        (command(Address(1, 0)), True, (3,)),  # for its whole system: also to its other components
        (command(CAMERA), False, (3,)),  # else only where the target was heard
        (command(OTHER), False, (2, 4)),
        (command(Address(2, 0)), False, (2, 3, 4)),
        (command(Address(2, 77)), False, (2, 3, 4)),
        (command(Address(2, 100)), False, (3,)),  # a component draws it away from the rest of its system
        (command(Address(9, 1)), False, ()),
    ],
)
def test_a_frame_goes_where_its_target_was_heard(
    wire: Wire, message: Message, is_ours: bool, channels: tuple[int, ...]
) -> None:
    router = router_with((2, OTHER), (4, OTHER), (3, CAMERA), (3, Address(2, 100)), (1, OTHER))
    way = router.route(1, wire.frame(GCS, message), 1.0)
    assert (way.is_ours, way.channels, way.is_addressed) == (is_ours, channels, message is not BEAT)
    assert router.unreachable == (not is_ours and not channels)


def test_a_target_cut_off_with_the_zeros_is_everybody(wire: Wire) -> None:
    nobody = dialect.MAVLink_param_request_list_message(0, 0)
    assert target_of(wire.frame(GCS, nobody)) == EVERYBODY
    assert target_of(wire.frame(GCS, dialect.MAVLink_param_request_list_message(0, 7))) == (0, 7)
    assert target_of(wire.frame(GCS, dialect.MAVLink_manual_control_message(9, 0, 0, 0, 0, 1))) == (9, 0)


@given(st.sampled_from(sorted(LAYOUTS)), st.binary(max_size=255))
def test_a_target_read_from_the_bytes_is_the_one_in_the_message(message_id: int, payload: bytes) -> None:
    layout = LAYOUTS[message_id]
    message = layout.unpack(payload)
    frame = Frame(message_id, GCS, 0, payload, b"", layout)
    system = getattr(message, "target_system", getattr(message, "target", 0))
    assert target_of(frame) == (system, getattr(message, "target_component", 0))


def test_our_own_words_that_come_back_end_here(wire: Wire) -> None:
    router = router_with()
    assert router.route(2, wire.frame(OWN), 0.0) == NOWHERE
    assert router.echoes == 1
    assert router.routes.addresses_on(2) == []


def test_a_frame_that_another_link_has_brought_is_dropped_and_one_said_twice_is_not(wire: Wire) -> None:
    router, frame = router_with(), wire.frame(OTHER)
    assert router.route(1, frame, 0.0).channels
    assert router.route(2, frame, 0.1) == NOWHERE
    assert router.route(1, frame, 0.2).channels
    assert router.repeats == 1
    assert router.route(2, frame, 5.0).channels, "long after it is a new one"
    both = router.route(3, wire.frame(GCS, command(OTHER)), 5.0).channels
    assert both == (1, 2), "the sender is within reach by both"


@given(st.lists(st.tuples(st.integers(1, 3), st.integers(0, 30), st.floats(0.0, 0.4)), max_size=200))
@example([(2, 0, 0.0), (1, 0, 0.1875), (1, 0, 0.25), (1, 0, 0.125)])
def test_no_frame_is_passed_on_for_two_links_within_half_a_window(
    seen: list[tuple[int, int, float]],
) -> None:
    repeats, now_s, first = DuplicateFilter(window_s=0.5), 0.0, dict[int, tuple[int, float]]()
    for channel, number, pause_s in seen:
        now_s += pause_s
        is_repeat = repeats.is_duplicate(bytes([number]), channel, now_s)
        brought = first.get(number)
        if brought is not None and brought[0] != channel and now_s - brought[1] < 0.25:
            assert is_repeat
        if brought is None or now_s - brought[1] > 0.5:
            assert not is_repeat
        if not is_repeat:
            first[number] = channel, now_s


def test_a_rebooted_system_is_looked_for_anew(wire: Wire) -> None:
    router = router_with((2, OTHER), (2, Address(2, 100)))

    def clock(boot_ms: int, channel: int, now_s: float) -> None:
        router.route(channel, wire.frame(OTHER, dialect.MAVLink_system_time_message(0, boot_ms)), now_s)

    clock(60_000, 2, 1.0)
    clock(57_000, 2, 1.1)  # overtaken on the way
    assert router.routes.flushes == 0
    clock(53_900, 3, 2.0)
    assert router.routes.flushes == 1
    assert router.route(1, wire.frame(GCS, command(OTHER)), 2.0).channels == (3,)


def test_a_route_expires_with_silence_and_lives_on_while_its_component_speaks(wire: Wire) -> None:
    router = router_with((2, OTHER), (3, CAMERA))
    for second in range(1, int(EXPIRY_S) + 5):
        router.route(3, wire.frame(CAMERA), float(second))
    assert router.route(1, wire.frame(GCS, command(CAMERA)), EXPIRY_S + 5).channels == (3,)
    assert router.route(1, wire.frame(GCS, command(OTHER)), EXPIRY_S + 5).channels == ()


def test_a_link_that_goes_takes_its_routes_with_it(wire: Wire) -> None:
    router = router_with((2, OTHER), (3, OTHER))
    router.forget(2)
    assert router.route(1, wire.frame(GCS, command(OTHER)), 0.0).channels == (3,)
    assert router.route(1, wire.frame(GCS), 0.0).channels == (3, 4)


def test_a_target_is_reached_once_it_was_heard_and_who_spoke_last_is_kept(wire: Wire) -> None:
    router = router_with()
    assert router.route(1, wire.frame(GCS, command(OTHER)), 0.0).channels == ()
    router.route(2, wire.frame(OTHER), 0.0)
    assert router.route(1, wire.frame(GCS, command(OTHER)), 0.0).channels == (2,)
    senders = [Address(3 + number % 250, 1 + number // 250) for number in range(MAX_HEARD)]
    for sender in (*senders[1:], OTHER, senders[0]):
        router.route(2, wire.frame(sender), 10.0)
    assert OTHER in router.routes.addresses_on(2)
    assert senders[1] not in router.routes.addresses_on(2)


def test_what_is_remembered_of_frames_is_bounded() -> None:
    repeats = DuplicateFilter(max_frames=100)
    for number in range(1000):
        repeats.is_duplicate(number.to_bytes(4, "little"), 1, 0.0)
    assert len(repeats._recent) + len(repeats._older) <= 100


def test_a_flood_of_addresses_displaces_no_system_of_another_link(wire: Wire) -> None:
    router = router_with((2, OTHER))
    for number in range(3000):
        sender = Address(3 + number % 250, 1 + number // 250)
        router.route(3, wire.frame(sender), 1.0)
        router.route(3, wire.frame(GCS, command(Address(sender.component, number % 256))), 1.0)
    assert len(router.routes.addresses_on(3)) == MAX_HEARD
    assert router.route(1, wire.frame(GCS, command(OTHER)), 1.0).channels == (2,)
    assert len(router._decisions) <= 4096


def test_a_link_that_does_not_forward_talks_with_the_boat_alone(wire: Wire) -> None:
    router = router_with((2, OTHER), links=2)
    router.open(3, forwards=False)
    way = router.route(3, wire.frame(GCS), 0.0)
    assert (way.is_ours, way.channels) == (True, ())
    assert router.route(3, wire.frame(GCS, command(OTHER)), 0.0).channels == ()
    assert router.route(1, wire.frame(OTHER), 5.0).channels == (2,)


@pytest.mark.parametrize(
    "message",
    [
        dialect.MAVLink_radio_status_message(200, 200, 80, 30, 30, 0, 0),
        dialect.MAVLink_setup_signing_message(0, 0, [1] * 32, 0),
    ],
    ids=["radio", "key"],
)
def test_what_concerns_one_link_stays_on_it(wire: Wire, message: Message) -> None:
    assert router_with().route(1, wire.frame(Address(51, 68), message), 0.0).channels == ()


def test_a_log_goes_only_to_who_asked_for_it(wire: Wire) -> None:
    router = router_with((2, OTHER), (1, GCS))
    data = dialect.MAVLink_log_data_message(1, 0, 90, [0] * 90)
    assert router.route(2, wire.frame(OTHER, data), 0.0).channels == ()
    router.route(3, wire.frame(GCS, dialect.MAVLink_log_request_data_message(*OTHER, 1, 0, 900)), 1.0)
    assert router.route(2, wire.frame(OTHER, data), 2.0).channels == (3,)
    assert router.route(2, wire.frame(OTHER, data), 100.0).channels == ()


def test_a_files_replies_go_only_where_they_were_asked_from(wire: Wire) -> None:
    router = router_with((1, GCS), (3, GCS), (2, OTHER))

    def transfer(target: Address, opcode: int) -> Message:
        payload = bytes([1, 0, 0, opcode]).ljust(251, b"\0")
        message: Message = dialect.MAVLink_file_transfer_protocol_message(0, *target, payload)
        return message

    assert router.route(3, wire.frame(GCS, transfer(OTHER, 4)), 1.0).channels == (2,)
    assert router.route(2, wire.frame(OTHER, transfer(GCS, 128)), 1.1).channels == (3,)
