"""A vehicle over MAVSDK's plugins: what is sent, what is tried again, what refusal and silence are called.

The plugins are made up here; tests/e2e/planner has the real ones, and a vehicle of pymavlink.
"""

import asyncio
import json
import logging
import os
import pty
import time
import tty
from collections.abc import AsyncIterator, Awaitable, Callable, Coroutine, Iterator
from types import SimpleNamespace
from typing import Any, cast

import pytest
from fake_clock import FakeClock
from mavsdk.asyncio import Configuration, MavsdkConnectionError, System
from mavsdk.plugins.mavlink_direct import MavlinkDirectError, MavlinkDirectResult, MavlinkMessage
from mavsdk.plugins.mission_raw import MissionItem as RawItem
from mavsdk.plugins.mission_raw import MissionRawError, MissionRawResult
from pymavlink.dialects.v20 import all as dialect

from companion.core.geo import LatLon
from companion.mavlink.signing import timestamp_at
from companion.mavlink.signing_key import SigningKey
from mission_tools.errors import (
    CommandRefused,
    LinkLost,
    NoVehicle,
    ReadBackMismatch,
    UploadRejected,
    VehicleError,
)
from mission_tools.mission.mission import MissionItem, MissionType
from mission_tools.vehicle import connection
from mission_tools.vehicle import vehicle as module
from mission_tools.vehicle.connection import connect
from mission_tools.vehicle.exchange import held_mission, send
from mission_tools.vehicle.link_url import parse_link
from mission_tools.vehicle.vehicle import Vehicle

WAYPOINT = MissionItem.at(LatLon(50.0, -1.2), params=(1.0, 2.0, 3.0, 4.0), z=5.0)
SPEED = MissionItem(178, 2, (1.0, 1.5, -1.0, 0.0), autocontinue=False)
SILENT = MissionRawError(MissionRawResult.TIMEOUT, "")
REFUSED = MissionRawError(MissionRawResult.INVALID_ARGUMENT, "")
ARM, START, INTERVAL = 400, 300, 511


class Plugins:
    """Keeps what it is told, and answers as it is set up."""

    def __init__(self) -> None:
        self.transfers: list[tuple[str, tuple[Any, ...]]] = []
        self.outcomes: list[object] = []  # of the next transfers: errors are raised
        self.messages: list[MavlinkMessage] = []
        self.results: list[int] = []  # of the next commands; accepted without
        self.heard: list[tuple[int, str]] = []  # component and fields of messages from the vehicle
        self.on_transfer: Callable[[], object] = lambda: None
        self.on_message: Callable[[dict[str, Any]], object] = lambda fields: None
        self.destroyed = 0

    def __getattr__(self, name: str) -> Callable[..., Awaitable[object]]:
        async def transfer(*arguments: object) -> object:
            self.transfers.append((name, arguments))
            self.on_transfer()
            outcome = self.outcomes.pop(0) if self.outcomes else None
            if isinstance(outcome, Exception):
                raise outcome
            return outcome

        return transfer

    async def send_message(self, message: MavlinkMessage) -> None:
        self.messages.append(message)
        self.on_message(json.loads(message.fields_json))

    async def send_command(self, message: MavlinkMessage) -> MavlinkMessage:
        await self.send_message(message)
        result = self.results.pop(0) if self.results else 0
        if result < 0:
            raise MavlinkDirectError(MavlinkDirectResult.TIMEOUT, "")
        return MavlinkMessage(fields_json=json.dumps({"result": result}))

    async def subscribe_message(self, name: str) -> AsyncIterator[object]:
        for component, fields in self.heard:
            yield SimpleNamespace(component_id=component, fields_json=fields)

    def destroy(self) -> None:
        self.destroyed += 1

    @property
    def fields(self) -> list[dict[str, Any]]:
        """Of the messages that were sent."""
        return [json.loads(message.fields_json) for message in self.messages]

    @property
    def commands(self) -> list[tuple[int, float]]:
        """Number and first parameter of each command that was sent."""
        return [(fields["command"], fields["param1"]) for fields in self.fields]


class Boat(Vehicle):
    """A vehicle with such plugins, on which time passes only while it is waited for."""

    def __init__(self, plugins: Plugins, clock: FakeClock, link: str = "tcp:boat:1") -> None:
        super().__init__(parse_link(link), cast(System, plugins), 7, clock.now_s)
        self.told: list[str] = []
        self.notify = self.told.append
        self.state.autopilot, self.state.custom_mode, self.state.says_more = 3, 4, True
        self.state.heard_s = 1e9

    def says(self, text: str, at_s: float = 0.1) -> None:
        self.state.texts.append((at_s, 3, text))


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> FakeClock:
    """The vehicle's clock; what sleeps lets it pass."""
    clock = FakeClock()

    async def sleep(seconds: float) -> None:
        clock.sleep(seconds)

    monkeypatch.setattr(asyncio, "sleep", sleep)
    return clock


@pytest.fixture
def plugins(monkeypatch: pytest.MonkeyPatch) -> Plugins:
    """Both of them, in place of MAVSDK's."""
    monkeypatch.setattr(module, "MissionRawAsync", lambda system: system)
    monkeypatch.setattr(module, "MavlinkDirectAsync", lambda system: system)
    return Plugins()


@pytest.fixture
def boat(plugins: Plugins, clock: FakeClock) -> Boat:
    """At HOLD, disarmed, an ArduPilot."""
    return Boat(plugins, clock)


def run(work: Coroutine[Any, Any, Any]) -> Any:  # noqa: ANN401  what it returns
    return asyncio.run(work)


def raw(seq: int, item: MissionItem, kind: int = 0) -> RawItem:
    head = (seq, item.frame, item.command, int(seq == 0), int(item.autocontinue))
    return RawItem(*head, *item.params, item.x, item.y, item.z, kind)


@pytest.mark.parametrize(
    ("kind", "up", "down"),
    [
        (MissionType.MISSION, "upload_mission", "download_mission"),
        (MissionType.FENCE, "upload_geofence", "download_geofence"),
        (MissionType.RALLY, "upload_rally_points", "download_rallypoints"),
    ],
)
def test_each_list_goes_up_and_comes_down_by_a_transfer_of_its_own(
    boat: Boat, plugins: Plugins, kind: MissionType, up: str, down: str
) -> None:
    run(boat.upload(kind, (WAYPOINT, SPEED)))
    sent = [raw(0, WAYPOINT, kind), raw(1, SPEED, kind)]
    assert [(name, [vars(item) for item in items]) for name, (items,) in plugins.transfers] == [
        (up, [vars(item) for item in sent])
    ]
    plugins.outcomes = [sent, MissionRawError(MissionRawResult.NO_MISSION_AVAILABLE, "")]
    assert run(boat.download(kind)) == (WAYPOINT, SPEED)
    assert plugins.transfers[1:] == [(down, ())]
    assert run(boat.download(kind)) == ()


@pytest.mark.parametrize(
    ("requested", "refused", "text", "said"),
    [
        (3, 10, "", "refused item 3: x or latitude is invalid"),
        (0, 10, "bad latitude", r"refused item 0: x or latitude is invalid \(bad latitude\)"),
        (-1, 99, "", "refused: MAV_MISSION_RESULT 99"),
    ],
)
def test_a_refusal_names_the_item_and_the_vehicles_reason(
    boat: Boat, plugins: Plugins, requested: int, refused: int, text: str, said: str
) -> None:
    def refuse() -> None:
        boat.state.requested_item, boat.state.refused = requested, refused
        if text:
            boat.says(text)

    boat.says("of before", -1.0)
    plugins.outcomes, plugins.on_transfer = [REFUSED], refuse
    with pytest.raises(UploadRejected, match=rf"^uploading the mission: the vehicle {said}$"):
        run(boat.upload(MissionType.MISSION, (WAYPOINT,)))
    assert len(plugins.transfers) == 1


@pytest.mark.parametrize(
    ("link", "text", "advice"),
    [
        ("tcp:boat:1", "", "; bring the vehicle nearer, or connect by UDP, and try again"),
        ("udpout:boat:1", "low battery", r"; bring the vehicle nearer, and try again \(low battery\)"),
    ],
)
def test_silence_is_tried_again_twice_and_then_told_with_advice(
    plugins: Plugins, clock: FakeClock, link: str, text: str, advice: str
) -> None:
    boat = Boat(plugins, clock, link)
    plugins.outcomes = [SILENT, SILENT, SILENT]
    if text:
        boat.says(text)
    plugins.on_transfer = lambda: setattr(boat.state, "refused", 13)  # of an item that came twice
    with pytest.raises(
        LinkLost, match=rf"^{link}: the vehicle stopped answering while reading .* fence{advice}$"
    ):
        run(boat.download(MissionType.FENCE))
    assert boat.told == ["no answer while reading back the fence: trying again"] * 2
    assert clock.time_s == pytest.approx(3 * 0.3 + 2 * 3.0)


def test_a_third_try_may_succeed_and_says_after_which_item_the_others_ended(
    boat: Boat, plugins: Plugins
) -> None:
    plugins.outcomes = [SILENT, MissionRawError(MissionRawResult.TRANSFER_CANCELLED, ""), None]
    plugins.on_transfer = lambda: setattr(boat.state, "requested_item", 2)
    run(boat.upload(MissionType.MISSION, (WAYPOINT,)))
    assert boat.told == ["no answer while uploading the mission, after item 2: trying again"] * 2


@pytest.mark.parametrize(
    ("is_lost", "said"), [(True, "bring the vehicle nearer"), (False, "--sign-key FILE")]
)
def test_where_another_try_would_find_the_same_there_is_none(
    boat: Boat, plugins: Plugins, is_lost: bool, said: str
) -> None:
    boat.state.heard_s = -6.0 if is_lost else 0.0
    boat.state.says_more = is_lost
    plugins.outcomes = [SILENT] * 3
    with pytest.raises(LinkLost, match=said):
        run(boat.upload(MissionType.MISSION, (WAYPOINT,)))
    assert len(plugins.transfers) == 1


@pytest.mark.parametrize("deaf", [0, 4])
def test_a_list_is_cleared_by_a_message_that_is_repeated(
    boat: Boat, plugins: Plugins, clock: FakeClock, deaf: int
) -> None:
    def answer(fields: dict[str, Any]) -> None:
        if len(plugins.messages) > deaf:
            boat.state.answers[fields["mission_type"]] = 0

    plugins.on_message = answer
    run(boat.clear(MissionType.RALLY))
    assert plugins.fields == [{"target_system": 7, "target_component": 1, "mission_type": 2}] * (deaf + 1)
    assert {
        (one.message_name, one.target_system_id, one.target_component_id) for one in plugins.messages
    } == {("MISSION_CLEAR_ALL", 7, 1)}
    assert clock.time_s == pytest.approx(deaf * 1.0, abs=0.1 * deaf)


def test_a_list_that_is_not_cleared_is_told(boat: Boat, plugins: Plugins) -> None:
    with pytest.raises(LinkLost, match="stopped answering while clearing the fence; bring"):
        run(boat.clear(MissionType.FENCE))
    assert len(plugins.messages) == 5
    plugins.on_message = lambda fields: boat.state.answers.update({MissionType.FENCE: 14})
    with pytest.raises(UploadRejected, match="clearing the fence: the vehicle refused: it takes no missions"):
        run(boat.clear(MissionType.FENCE))


def obey(boat: Boat, plugins: Plugins) -> None:
    """Let commands that are accepted take effect."""

    def change(fields: dict[str, Any]) -> None:
        if plugins.results and plugins.results[0]:
            return
        if fields["command"] == ARM:
            boat.state.armed = fields["param1"] == 1.0
        elif fields["command"] == START:
            boat.state.custom_mode = 10

    plugins.on_message = change


@pytest.mark.parametrize(("autopilot", "first"), [(3, 1), (12, 0)])
def test_a_start_is_the_first_item_arming_and_the_mission(
    boat: Boat, plugins: Plugins, autopilot: int, first: int
) -> None:
    boat.state.autopilot, boat.state.reached_item = autopilot, 5
    plugins.outcomes = [MissionRawError(MissionRawResult.DENIED, "")]  # the vehicle cannot choose an item
    obey(boat, plugins)
    run(boat.start(10.0))
    assert plugins.transfers == [("set_current_mission_item", (first,))]
    assert plugins.commands == [(ARM, 1.0), (START, 0.0)]
    assert boat.state.reached_item == -1
    run(boat.start(10.0))
    assert plugins.commands[2:] == [(START, 0.0)]  # it is armed


@pytest.mark.parametrize(("patience_s", "tries"), [(1.2, 1), (2.5, 2), (2.7, 3)])
def test_arming_is_asked_for_again_until_the_patience_ends(
    boat: Boat, plugins: Plugins, patience_s: float, tries: int
) -> None:
    plugins.results = [4] * 9
    boat.says("Arm: no fix")
    with pytest.raises(CommandRefused, match=r"^the vehicle refused to arm: Arm: no fix$"):
        run(boat.start(patience_s))
    assert plugins.commands == [(ARM, 1.0)] * tries


@pytest.mark.parametrize("was_armed", [False, True])
def test_a_boat_that_was_armed_for_a_start_which_it_refuses_is_disarmed_again(
    boat: Boat, plugins: Plugins, was_armed: bool
) -> None:
    boat.state.armed = was_armed
    plugins.results = [4] if was_armed else [0, 4]
    obey(boat, plugins)
    with pytest.raises(CommandRefused, match="refused to start the mission: failed"):
        run(boat.start(10.0))
    assert boat.state.armed is was_armed
    assert plugins.commands[-1] == ((START, 0.0) if was_armed else (ARM, 0.0))


def test_a_start_that_changes_no_mode_is_told_and_so_is_silence_after_it(
    boat: Boat, plugins: Plugins, clock: FakeClock
) -> None:
    boat.state.armed = True
    with pytest.raises(CommandRefused, match="took the start but stays in HOLD, not AUTO"):
        run(boat.start(2.0))
    assert clock.time_s == pytest.approx(2.0, abs=0.1)
    boat.state.heard_s = clock.time_s
    with pytest.raises(
        LinkLost, match=r"tcp:boat:1: lost the vehicle while starting .*: no heartbeat for 5 s"
    ):
        run(boat.start(20.0))


@pytest.mark.parametrize(("result", "said"), [(3, "not supported"), (99, "MAV_RESULT 99")])
def test_a_refusal_without_a_text_is_told_by_its_result(
    boat: Boat, plugins: Plugins, result: int, said: str
) -> None:
    plugins.results = [result]
    with pytest.raises(CommandRefused, match=rf"refused to arm: {said}$"):
        run(boat.start(0.0))


def test_a_command_without_an_answer_is_silence(boat: Boat, plugins: Plugins) -> None:
    plugins.results = [-1]
    with pytest.raises(LinkLost, match="does not answer the request to arm; bring the vehicle nearer"):
        run(boat.start(10.0))


def test_rates_are_asked_for_and_a_vehicle_that_cannot_is_left_alone(boat: Boat, plugins: Plugins) -> None:
    def refuse(fields: dict[str, Any]) -> None:
        if fields["param1"] == 33.0:
            raise MavlinkDirectError(MavlinkDirectResult.ERROR, "")

    plugins.on_message = refuse
    run(boat.ask_for_rates())
    head = {"target_system": 7, "target_component": 1, "command": INTERVAL, "confirmation": 0}
    assert plugins.fields == [
        head | {"param1": 33.0, "param2": 250_000.0},
        head | {"param1": 42.0, "param2": 5e5},
    ]
    (message, _) = plugins.messages
    assert (message.message_name, message.system_id, message.component_id) == ("COMMAND_LONG", 0, 0)


def test_what_the_vehicle_says_is_its_state_and_nonsense_is_passed_over(
    boat: Boat, plugins: Plugins, caplog: pytest.LogCaptureFixture
) -> None:
    caplog.set_level(logging.DEBUG)
    reached = json.dumps({"seq": 3})
    plugins.heard = [(1, "{"), (1, "{}"), (1, "null"), (2, json.dumps({"seq": 9})), (1, reached)]
    run(boat.watch("MISSION_ITEM_REACHED"))
    assert boat.state.reached_item == 3
    assert caplog.text.count("MISSION_ITEM_REACHED that makes no sense") == 3

    async def of_the_autopilot() -> list[str]:
        return [fields async for fields in boat.messages("ATTITUDE")]

    assert run(of_the_autopilot()) == ["{", "{}", "null", reached]
    boat.close()
    assert plugins.destroyed == 2


# What is sent is read back


def test_lists_are_replaced_or_cleared_and_read_until_they_are_equal(
    boat: Boat, plugins: Plugins, clock: FakeClock
) -> None:
    plugins.on_message = lambda fields: boat.state.answers.update({MissionType.FENCE: 0})
    late: tuple[object, object] = [raw(0, WAYPOINT)], []
    plugins.outcomes = [None, *late, *late, [raw(0, WAYPOINT), raw(1, SPEED)], []]
    run(send(boat, {MissionType.MISSION: (WAYPOINT, SPEED), MissionType.FENCE: ()}))
    assert [name for name, _ in plugins.transfers] == [
        "upload_mission",
        *["download_mission", "download_geofence"] * 3,
    ]
    assert clock.time_s == pytest.approx(2 * 3.0)


def test_a_list_that_stays_different_is_told_by_list_item_and_field(boat: Boat, plugins: Plugins) -> None:
    plugins.outcomes = [None, *[[raw(0, MissionItem(17, 0, z=1.0))]] * 3]
    with pytest.raises(
        ReadBackMismatch, match=r"sent: fence, item 0: command sent NAV_WAYPOINT.* and 6 more$"
    ):
        run(send(boat, {MissionType.FENCE: (WAYPOINT,)}))
    boat.state.autopilot = 12
    plugins.outcomes = [None, *[[raw(0, SPEED), raw(1, SPEED)]] * 3]
    with pytest.raises(ReadBackMismatch, match=r"sent: item 1: number of items sent 1, held 2$"):
        run(send(boat, {MissionType.MISSION: (SPEED,)}))


def test_a_fence_on_board_that_is_none_is_the_vehicles_error(boat: Boat, plugins: Plugins) -> None:
    plugins.outcomes = [[raw(0, WAYPOINT), raw(1, SPEED)], [], []]
    assert run(held_mission(boat)).items == (SPEED,)
    plugins.outcomes = [[], [raw(0, WAYPOINT)], []]
    with pytest.raises(VehicleError, match=r"^tcp:boat:1: on board: fence, item 0: MAV_CMD 16 is none"):
        run(held_mission(boat))


# The link is opened by MAVSDK, or by us where it is signed


class Sdk:
    """MAVSDK, with a vehicle behind any link or none."""

    def __init__(self, vehicle: Plugins | None, on_open: Callable[[], object] = lambda: None) -> None:
        self.vehicle, self.on_open = vehicle, on_open
        self.urls: list[str] = []
        self.passed: list[bytes] = []  # what we hand to it
        self.send: Callable[[bytes], None] | None = None
        self.ids = (0, 0)
        self._mavsdk = self

    def __call__(self, configuration: Configuration) -> "Sdk":
        self.ids = configuration.system_id, configuration.component_id
        return self

    async def __aenter__(self) -> "Sdk":
        return self

    async def __aexit__(self, *error: object) -> None:
        pass

    async def add_any_connection(self, url: str) -> None:
        if "taken" in url:
            raise MavsdkConnectionError("in use")
        self.urls.append(url)

    async def first_autopilot(self, timeout_s: float) -> Plugins | None:
        end_s = time.monotonic() + timeout_s
        while self.send is not None and len(self.passed) < 2 and time.monotonic() < end_s:
            await asyncio.sleep(0.01)
        return self.vehicle

    def pass_received_raw_bytes(self, data: bytes) -> None:
        self.passed.append(data)

    def subscribe_raw_bytes_to_be_sent(self, send: Callable[[bytes], None]) -> int:
        self.send = send
        self.on_open()
        return 5

    def unsubscribe_raw_bytes_to_be_sent(self, handle: int) -> None:
        assert handle == 5
        self.send = None


def connected(
    sdk: Sdk, link: str, monkeypatch: pytest.MonkeyPatch, key: SigningKey | None = None
) -> tuple[Vehicle, set[str]]:
    """The vehicle, and the messages that were taken in while it was there."""

    async def meet() -> tuple[Vehicle, set[str]]:
        async with connect(parse_link(link), 0.2, key=key) as vehicle:
            if sdk.send is not None:
                sdk.send(bytes(HEARTBEAT.pack(dialect.MAVLink(None, 246, 191))))
                await asyncio.sleep(0.02)
            running = {str(task.get_coro()) for task in asyncio.all_tasks()}
        assert len(asyncio.all_tasks()) == 1
        return vehicle, running

    monkeypatch.setattr(connection, "Mavsdk", sdk)
    vehicle, running = asyncio.run(meet())
    return vehicle, {one for one in running if "Vehicle.watch" in one}


KEY = SigningKey.from_passphrase("correct horse")
HEARTBEAT = dialect.MAVLink_heartbeat_message(11, 3, 129, 4, 4, 3)
SAYS_HOLD = json.dumps({"autopilot": 3, "type": 11, "custom_mode": 4, "base_mode": 1})


class Talking(Plugins):
    """Says its heartbeat, and then goes on."""

    async def subscribe_message(self, name: str) -> AsyncIterator[object]:
        async for message in super().subscribe_message(name):
            yield message
        await asyncio.Event().wait()


@pytest.fixture
def talking(plugins: Plugins) -> Plugins:
    """A vehicle of id 7 in HOLD."""
    talking = Talking()
    talking.outcomes, talking.heard = [7], [(1, SAYS_HOLD)]
    return talking


def test_a_vehicle_is_met_as_an_onboard_computer_and_watched_until_the_end(
    talking: Plugins, monkeypatch: pytest.MonkeyPatch
) -> None:
    sdk = Sdk(talking)
    vehicle, watched = connected(sdk, "tcp:boat:1", monkeypatch)
    assert (sdk.ids, sdk.urls) == ((246, 191), ["tcpout://boat:1"])
    assert (vehicle.system_id, vehicle.state.mode, len(watched)) == (7, "HOLD", 8)
    assert [first for _, first in talking.commands] == [33.0, 42.0]
    assert talking.destroyed == 2


@pytest.mark.parametrize(
    ("link", "vehicle", "said"),
    [
        ("tcp:taken:1", None, "cannot be opened (in use): {advice}"),
        ("tcp:boat:1", None, "no vehicle within 0.2 s: {advice}"),
        ("tcp:boat:1", Plugins(), "the vehicle fell silent after its first heartbeat: {advice}"),
    ],
)
@pytest.mark.usefixtures("plugins")
def test_where_no_vehicle_is_met_there_is_advice(
    link: str, vehicle: Plugins | None, said: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(connection, "SILENCE_S", 0.0)
    with pytest.raises(NoVehicle) as raised:
        connected(Sdk(vehicle), link, monkeypatch)
    assert str(raised.value) == f"{link}: {said.format(advice=parse_link(link).advice)}"
    assert vehicle is None or vehicle.destroyed == 2


@pytest.fixture
def line() -> Iterator[tuple[int, str]]:
    """A serial line: the boat's end, and the name of ours."""
    theirs, ours = pty.openpty()
    tty.setraw(ours)
    yield theirs, os.ttyname(ours)
    os.close(theirs)
    os.close(ours)


def test_over_a_signed_line_both_ways_are_signed_and_the_vehicle_hears_no_more_after_its_end(
    talking: Plugins, line: tuple[int, str], monkeypatch: pytest.MonkeyPatch
) -> None:
    theirs, ours = line
    boat = dialect.MAVLink(None, 7, 1)
    boat.signing.secret_key, boat.signing.sign_outgoing = KEY.reveal(), True
    boat.signing.timestamp = timestamp_at(time.time())
    sdk = Sdk(talking, lambda: [os.write(theirs, bytes(HEARTBEAT.pack(boat))) for _ in range(2)])
    connected(sdk, ours, monkeypatch, KEY)
    assert sdk.urls == ["raw://"]
    assert len(sdk.passed) == 2
    assert sdk.send is None
    assert [message.get_type() for message in boat.parse_buffer(os.read(theirs, 100))] == ["HEARTBEAT"]


def test_a_signed_link_that_hears_the_unsigned_says_so(
    line: tuple[int, str], monkeypatch: pytest.MonkeyPatch
) -> None:
    theirs, ours = line
    plain = bytes(HEARTBEAT.pack(dialect.MAVLink(None, 7, 1)))
    with pytest.raises(
        NoVehicle, match=r"no vehicle within 0\.2 s: what it says is not signed: give the boat"
    ):
        connected(Sdk(None, lambda: os.write(theirs, plain)), ours, monkeypatch, KEY)
    with pytest.raises(NoVehicle, match=r"/dev/missing: cannot be opened \(.*\): "):
        connected(Sdk(None), "/dev/missing", monkeypatch, KEY)
