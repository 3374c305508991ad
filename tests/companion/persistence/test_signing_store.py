import logging
import stat
from pathlib import Path
from typing import TypeVar

import pytest
from held_storage import HeldStorage
from hypothesis import given
from hypothesis import strategies as st

from companion.core.errors import ConfigError
from companion.core.storage import FolderStorage, MemoryStorage
from companion.mavlink.signing import EPOCH_UNIX_S, TICKS_PER_S, SignatureVerdict, Stamps, sign, timestamp_at
from companion.mavlink.signing_key import SigningKey, read_key_file
from companion.persistence.signing_store import KEY_FILE, MAX_KEYS, STAMPS_FILE, KeyFloors, SigningStore

KEY = SigningKey.from_passphrase("correct horse")
UNIX_S = 1.8e9
NOW = timestamp_at(UNIX_S)
HEARTBEAT = bytes.fromhex("fd09000000ffbe000000000000000608000403") + b"\x00\x00"


S = TypeVar("S", bound=MemoryStorage)


def keyed(storage: S) -> S:
    storage.content[KEY_FILE] = KEY.reveal().hex().encode()
    return storage


def take(stamps: Stamps) -> int:
    stamp = stamps.take()
    assert stamp is not None
    return stamp


def test_a_crash_at_any_moment_repeats_no_timestamp() -> None:
    storage = keyed(HeldStorage())
    used = 0
    for number in range(60):
        store = SigningStore(storage, UNIX_S + number)
        for tick in range(number):
            if tick == number // 2:
                storage.finish()
            store.tick(UNIX_S + number + tick * 7.0)
            stamp = store.stamps.take()
            if stamp is not None:
                assert stamp > used
                used = stamp
        storage.under_way.clear()  # the power goes


@given(st.lists(st.tuples(st.floats(0.0, 4e9), st.integers(0, 30)), max_size=20))
def test_restarts_with_any_clock_repeat_no_timestamp(starts: list[tuple[float, int]]) -> None:
    storage, used = keyed(MemoryStorage()), 0
    for unix_s, frames in starts:
        store = SigningStore(storage, unix_s)
        for number in range(frames):
            store.tick(unix_s - number)
            stamp = take(store.stamps)
            assert stamp > used
            used = stamp


def test_the_medium_is_written_twice_a_minute_not_with_every_frame() -> None:
    storage = keyed(HeldStorage())
    store = SigningStore(storage, UNIX_S)
    writes = 0
    for tick in range(50 * 600):
        writes += len(storage.under_way)
        storage.finish()
        store.tick(UNIX_S + tick * 0.02)
        take(store.stamps) if tick else None
    assert 15 <= writes <= 25


def test_what_was_heard_before_a_clean_restart_is_refused_after_it() -> None:
    storage = keyed(MemoryStorage())
    store = SigningStore(storage, UNIX_S)
    last = sign(HEARTBEAT, KEY, 0, NOW + 17)
    assert store.boat.check(last) is SignatureVerdict.GOOD
    store.close()
    again = SigningStore(storage, UNIX_S)
    assert again.boat.check(last) is SignatureVerdict.OLD
    assert again.boat.check(sign(HEARTBEAT, KEY, 0, NOW + 18)) is SignatureVerdict.GOOD


def test_a_key_is_kept_over_a_restart_in_a_file_of_its_owner_alone(tmp_path: Path) -> None:
    storage = FolderStorage(tmp_path)
    store = SigningStore(storage, UNIX_S)
    store.change_key(KEY, NOW)
    store.change_key(KEY, NOW)
    storage.close()
    path = tmp_path / KEY_FILE
    assert stat.S_IMODE(path.stat().st_mode) == 0o600
    assert read_key_file(path) == KEY
    assert SigningStore(FolderStorage(tmp_path), UNIX_S).boat.key == KEY


OTHER = SigningKey.from_passphrase("battery staple")


def heartbeat_at(stamp: int, key: SigningKey = KEY) -> bytes:
    return sign(HEARTBEAT, key, 0, stamp)


@pytest.mark.parametrize("between", [OTHER, None], ids=["another key", "no key"])
@pytest.mark.parametrize("restarts", ["never", "under the other key", "after both"])
def test_a_key_that_comes_back_does_not_make_recorded_frames_valid_again(
    between: SigningKey | None, restarts: str
) -> None:
    storage = keyed(MemoryStorage())
    store = SigningStore(storage)
    recorded = [heartbeat_at(NOW + second * TICKS_PER_S) for second in range(5)]
    for frame in recorded:
        assert store.boat.check(frame) is SignatureVerdict.GOOD
    store.change_key(between, 0)
    if restarts == "under the other key":
        store = SigningStore(storage)
    store.change_key(KEY, 0)
    if restarts == "after both":
        store = SigningStore(storage)
    assert {store.boat.check(frame) for frame in recorded} == {SignatureVerdict.OLD}
    assert store.boat.check(heartbeat_at(NOW + 6 * TICKS_PER_S)) is SignatureVerdict.GOOD


def test_as_many_keys_as_are_remembered_do_not_bind_each_other() -> None:
    assert MAX_KEYS == 16
    keys = [SigningKey.from_passphrase(f"key {number}") for number in range(MAX_KEYS)]
    floors = KeyFloors()
    for number, key in enumerate(keys):
        floors.record(key, 1000 + number)
    assert [floors.of(key) for key in keys] == [1000 + number for number in range(MAX_KEYS)]
    assert floors.of(KEY) == 0
    floors.record(keys[0], 2000)
    floors.record(KEY, 5)
    assert (floors.of(None), floors.of(KEY), floors.of(keys[0])) == (0, 5, 2000), "the latest are remembered"
    assert floors.of(keys[1]) == floors.of(OTHER) == 1001, "who was displaced binds whoever is not known"
    floors.record(KEY, 3)
    assert floors.of(KEY) == 5


def test_a_change_of_the_boats_key_does_not_reopen_the_links_with_a_key_of_their_own(tmp_path: Path) -> None:
    path = tmp_path / "radio.key"
    path.write_bytes(b"battery staple\n")
    path.chmod(0o600)
    storage = keyed(MemoryStorage())
    store = SigningStore(storage)
    recorded = heartbeat_at(NOW, OTHER)
    assert store.signatory(str(path)).check(recorded) is SignatureVerdict.GOOD
    store.change_key(SigningKey.from_passphrase("a third"), 0)
    assert store.signatory(str(path)).check(recorded) is SignatureVerdict.OLD
    again = SigningStore(storage)
    assert again.signatory(str(path)).check(recorded) is SignatureVerdict.OLD


def test_links_with_the_same_key_file_share_what_they_have_heard(tmp_path: Path) -> None:
    path = tmp_path / "radio.key"
    path.write_bytes(b"correct horse\n")
    path.chmod(0o600)
    store = SigningStore(MemoryStorage(), UNIX_S)
    assert store.signatory("") is store.boat
    radio = store.signatory(str(path))
    assert radio is store.signatory(str(path))
    assert radio.key == KEY
    assert radio.sign(HEARTBEAT, 1) is not None
    path.chmod(0o644)
    with pytest.raises(ConfigError, match="chmod 600"):
        SigningStore(MemoryStorage()).signatory(str(path))


@given(st.binary(max_size=60))
def test_files_that_are_none_of_ours_are_told_of_and_ignored(content: bytes) -> None:
    storage = MemoryStorage()
    storage.content |= {STAMPS_FILE: content, KEY_FILE: KEY.reveal().hex().encode()}
    assert take(SigningStore(storage, UNIX_S).stamps) >= NOW


@pytest.mark.parametrize(
    "content",
    [
        b"[]",
        b"{}",
        b'{"first": -1, "seen": 0}',
        b'{"first": 1e400, "seen": 0}',
        b'{"first": 1, "seen": 0, "proved": 7}',
        b'{"first": 1, "seen": 0, "proved": {"keys": 7, "others": 0}}',
        b'{"first": 1, "seen": 0, "proved": {"keys": {"a": -1}, "others": 0}}',
        b'{"first": 1, "seen": 0, "proved": {"keys": {}, "others": "x"}}',
    ],
)
def test_a_damaged_file_of_timestamps_is_named(content: bytes, caplog: pytest.LogCaptureFixture) -> None:
    storage = keyed(MemoryStorage())
    storage.content[STAMPS_FILE] = content
    with caplog.at_level(logging.WARNING):
        store = SigningStore(storage, EPOCH_UNIX_S + 1.0)
    assert STAMPS_FILE in caplog.text
    assert take(store.stamps) == TICKS_PER_S


@pytest.mark.parametrize("order", [(KEY_FILE, STAMPS_FILE), (STAMPS_FILE, KEY_FILE)])
def test_a_new_key_is_reported_only_when_the_boat_can_sign_the_report(order: tuple[str, str]) -> None:
    storage = HeldStorage()
    store = SigningStore(storage, UNIX_S)
    store.change_key(KEY, NOW)
    for name in order:
        assert store.key_saved() is None
        storage.finish(only=name)
        store.tick(UNIX_S)
    assert store.key_saved() == ""
    assert store.boat.sign(HEARTBEAT, 0) is not None
