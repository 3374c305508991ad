"""What a boat says and does when something that it had stored is damaged at its start."""

from collections.abc import Callable
from pathlib import Path

import pytest
from boat_rig import FAILED, OK, PLANNER, Peer, Rig, waypoint
from mission_station import RALLY

from companion.core.storage import FolderStorage, InlineExecutor
from companion.mavlink.dialect import dialect
from companion.mavlink.items import MissionItem, MissionType
from companion.mavlink.signing_key import SigningKey
from companion.mavlink.transfer import Completed
from companion.persistence.mission_store import FIRST_S, REPEAT_S, DataLosses
from companion.persistence.signing_store import AHEAD, KEY_FILE, STAMPS_FILE, SigningStore

pytestmark = pytest.mark.slow

PREVIOUS = "is damaged, the previous one is in use"
NONE = "is damaged, there is no previous one"


def wide(radius_m: float) -> list[MissionItem]:
    """A fence round the boat."""
    return [MissionItem(frame=0, command=5003, param1=radius_m, x=500_000_000, y=-12_000_000)]


class StoredRig(Rig):
    """A boat whose memory is a folder, into which the test reaches between two runs."""

    def __init__(self, folder: Path, config: dict[str, object] | None = None) -> None:
        self.folder = folder
        super().__init__(storage=FolderStorage(folder, worker=InlineExecutor()), config=config)

    def keep(self, items: list[MissionItem], kind: MissionType) -> None:
        """Upload a list."""
        assert isinstance(self.upload(items, mission_type=kind), Completed)

    def damage(self, name: str) -> None:
        """A bit flips in the newest generation of a file while power is off; then the boat starts."""
        self.world._motors.stop()
        file = bytearray((self.folder / name).read_bytes())
        file[-3] ^= 0x10
        (self.folder / name).write_bytes(file)
        self.reboot()


@pytest.fixture
def rig(tmp_path: Path) -> StoredRig:
    return StoredRig(tmp_path)


def lines(peer: Peer, begin: str) -> list[str]:
    return [text for text in peer.texts if text.startswith(begin)]


def test_a_boat_whose_fence_is_lost_says_so_and_does_not_arm(rig: StoredRig) -> None:
    rig.ready()
    rig.keep(wide(300.0), MissionType.FENCE)
    rig.damage("fence.json")
    other = rig.connect(PLANNER)
    rig.run(10.0)
    for peer in (rig.peer, other):
        assert lines(peer, "Fence lost: ") == [f"Fence lost: fence.json {NONE}. Upload or clear the fence"]
        assert "PreArm: Fence: the stored fence is lost: upload or clear it" in peer.texts
    assert rig.arm() == FAILED
    assert "Arm: Fence: the stored fence is lost: upload or clear it" in rig.peer.texts
    health = rig.peer.said("SYS_STATUS")
    assert not any(one.onboard_control_sensors_health & dialect.MAV_SYS_STATUS_PREARM_CHECK for one in health)


def test_a_lost_list_is_reported_and_does_not_prevent_arming(rig: StoredRig) -> None:
    rig.ready()
    rig.keep(RALLY, MissionType.RALLY)
    rig.damage("rally.json")
    rig.ready()
    rig.run(FIRST_S + 1.0)
    begin = f"Rally lost: rally.json {NONE}. Upload or clear the "
    assert len(lines(rig.peer, begin)) == 1
    assert rig.arm() == OK
    rig.keep(RALLY, MissionType.RALLY)
    rig.peer.forget()
    rig.run(REPEAT_S)
    assert not lines(rig.peer, begin)


def test_the_boat_starts_with_deeply_nested_files(rig: StoredRig) -> None:
    names = ("mission.json", "fence.json", "rally.json", "voyage.json")
    for name in (*names, "trail.json", "params.parm", STAMPS_FILE):
        rig.storage.save(name, b"[" * 100_000)
    rig.reboot()
    rig.run(10.0)
    assert rig.boat.net.faults == 0
    told = " ".join(rig.peer.texts)
    assert [name for name in names if f" lost: {name} cannot be read" not in told] == []


def test_parameters_of_the_previous_generation_are_used_and_any_set_ends_the_notice(rig: StoredRig) -> None:
    rig.ready()
    for radius_m in (3.0, 4.0):
        assert rig.boat.parameters.set("WP_RADIUS", radius_m) == ""
        rig.step(2)
    rig.damage("params.parm")
    rig.run(10.0)
    assert rig.boat.parameters.config.guidance.waypoint_radius_m == 3.0
    told = f"Parameters lost: params.parm {PREVIOUS}. Set any parameter to keep what is in use"
    assert lines(rig.peer, "Parameters lost") == [told]
    rig.peer.send(dialect.MAVLink_param_set_message(1, 1, b"HDG_KP", 3.5, dialect.MAV_PARAM_TYPE_REAL32))
    rig.receive()
    rig.step(2)
    rig.peer.forget()
    rig.run(REPEAT_S + 1.0)
    assert not lines(rig.peer, "Parameters lost")


def under_way(rig: StoredRig) -> None:
    rig.sail(waypoint(30.0, 0.0), waypoint(30.0, 60.0))
    rig.run(20.0)


@pytest.mark.parametrize(
    ("name", "what"), [("voyage.json", "Voyage record"), ("trail.json", "Track of SMART_RTL")]
)
def test_a_damaged_record_of_the_voyage_is_told_until_the_boat_is_armed(
    rig: StoredRig, name: str, what: str
) -> None:
    under_way(rig)
    rig.damage(name)
    rig.ready()
    rig.run(10.0)
    assert lines(rig.peer, f"{what} lost: {name} {PREVIOUS}. Arming begins a new one")
    assert rig.arm() == OK
    rig.run(1.0)
    rig.peer.forget()
    rig.run(REPEAT_S + 1.0)
    assert not lines(rig.peer, what)


def keyed(folder: Path) -> StoredRig:
    rig = StoredRig(folder)
    for secret in (1, 2):
        rig.boat.signing.change_key(SigningKey(bytes([secret] * 32)), 1)
        rig.step(2)
    rig.boat.signing.close()
    rig.step(2)
    return rig


def test_a_damaged_key_leaves_the_previous_one_in_use_not_an_open_boat(tmp_path: Path) -> None:
    rig = keyed(tmp_path)
    rig.damage(KEY_FILE)
    assert rig.boat.signing.boat.key == SigningKey(bytes([1] * 32))
    assert rig.boat.vehicle.data_losses.text("signing key") == (
        f"Signing key lost: {KEY_FILE} {PREVIOUS}. Set or remove the signing key"
    )
    rig.boat.signing.change_key(SigningKey(bytes([3] * 32)), 1)
    rig.run(1.0)
    assert rig.boat.vehicle.data_losses.text("signing key") == ""


def test_timestamps_begin_beyond_those_of_a_damaged_file(tmp_path: Path) -> None:
    storage = FolderStorage(tmp_path, worker=InlineExecutor())
    storage.save(KEY_FILE, b"01" * 32)
    for first in (1000, 1000 + AHEAD):  # a lead is written anew when half of the one before is used up
        storage.save(STAMPS_FILE, b'{"first": %d, "seen": 0}' % first)
    (tmp_path / STAMPS_FILE).write_bytes(b"")
    store = SigningStore(FolderStorage(tmp_path, worker=InlineExecutor()))
    signed = store.boat.sign(bytes.fromhex("fd0901000000010100000000000000000000000203510403aabb"), 1)
    assert signed is not None
    assert int.from_bytes(signed[-12:-6], "little") >= 1000 + AHEAD
    assert store.losses == {"signing timestamps": f"{STAMPS_FILE} {PREVIOUS}"}


def test_a_loss_is_told_soon_then_at_intervals_until_it_ends() -> None:
    losses = DataLosses()
    losses.add("fence", "it is damaged", "Upload it")
    tell: Callable[[float], list[str]] = losses.update
    assert [tell(FIRST_S - 0.1), tell(FIRST_S), tell(FIRST_S + REPEAT_S - 0.1)] == [
        [],
        ["Fence lost: it is damaged. Upload it"],
        [],
    ]
    assert tell(FIRST_S + REPEAT_S) != []
    losses.end("fence")
    losses.end("rally")
    assert tell(1e9) == []
    assert (FIRST_S, REPEAT_S) == (5.0, 30.0)  # as PreArm lines
