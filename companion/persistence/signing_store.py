"""Persistent state of signing: the boat's key and the timestamps.

Timestamps are reserved ahead: the stored one has certainly not been used, so none is repeated after a crash.
The date may be wrong or missing at the next start; the count continues.
"""

import json
import logging
from collections import OrderedDict
from pathlib import Path
from typing import Any

from companion.core.storage import Saving, Storage
from companion.mavlink.signing import NEVER, TICKS_PER_S, Signatory, Stamps, timestamp_at
from companion.mavlink.signing_key import SigningKey, parse_key, read_key_file

logger = logging.getLogger(__name__)

KEY_FILE = "signing.key"
STAMPS_FILE = "signing.json"
MAX_KEYS = 16  # with a floor of their own
AHEAD = 60 * TICKS_PER_S  # of the time; a restart continues from there
_AHEAD_OF_LAST = TICKS_PER_S  # if the count is ahead of the time


class KeyFloors:
    """Highest timestamp proven per key: a frame must be newer than the floor of its key.

    A key that returns after another one (A, B, A) must not make recorded frames valid. The highest proven
    timestamp of each key is stored with a tag of the key. For keys displaced from the table, the highest of
    their timestamps applies to every key that is not in it.

    others: the floor of keys not in the table.
    """

    def __init__(self, floors: dict[str, int] | None = None, others: int = 0) -> None:
        self._floors = OrderedDict(floors or {})
        self._others = others

    def of(self, key: SigningKey | None) -> int:
        """The floor of a key, 0 without a key."""
        return 0 if key is None else self._floors.get(key.tag, self._others)

    def record(self, key: SigningKey | None, timestamp: int) -> None:
        """Record a proven timestamp."""
        if key is None:
            return
        self._floors[key.tag] = max(timestamp, self.of(key))
        self._floors.move_to_end(key.tag)
        while len(self._floors) > MAX_KEYS:
            _, floor = self._floors.popitem(last=False)
            self._others = max(self._others, floor)

    def to_tree(self) -> dict[str, Any]:
        return {"keys": dict(self._floors), "others": self._others}

    @classmethod
    def from_tree(cls, tree: Any, seen: int) -> "KeyFloors":  # noqa: ANN401
        """From the file; earlier versions store one timestamp for all keys, `seen`.
        Raises KeyError, TypeError, ValueError: invalid content.
        """
        if tree is None:
            return cls(others=seen)
        floors, others = dict(tree["keys"]), tree["others"]
        if not all(isinstance(stamp, int) and 0 <= stamp < NEVER for stamp in (*floors.values(), others)):
            raise ValueError("no timestamps by key in it")
        return cls(floors, others)


class SigningStore:
    """The keys of all links, and their shared timestamps. unix_s: Unix time, 0 if unknown."""

    def __init__(self, storage: Storage, unix_s: float = 0.0) -> None:
        self._storage = storage
        self.losses: dict[str, str] = {}  # by file: what is lost, and what is used instead
        first, seen, self._floors = self._load_stamps()
        self.stamps = Stamps(first, seen, limit=first)
        self.stamps.clock = timestamp_at(unix_s)
        key = self._load_key()
        self.boat = Signatory(key, self.stamps, self._floors.of(key))
        self._of_files: dict[str, Signatory] = {}
        self._saving: Saving | None = None
        self._reserved = first
        self._key_saving: Saving | None = None
        self._is_closed = False
        self.is_active = self.boat.key is not None  # whether there is any key
        self._reserve()

    def signatory(self, key_file: str) -> Signatory:
        """The signatory of a key file; without a name, the boat's own.
        Raises ConfigError: the file has no key, or others may read it.
        """
        if not key_file:
            return self.boat
        if key_file not in self._of_files:
            key = read_key_file(Path(key_file).expanduser())
            self._of_files[key_file] = Signatory(key, self.stamps, self._floors.of(key))
            self.is_active = True
            self._reserve()
        return self._of_files[key_file]

    def change_key(self, key: SigningKey | None, first: int) -> None:
        """Replace or remove the boat's key; first: the timestamp that its holders have reached.

        The count restarts, as a clock may have run ahead; but never below what was proven under the same key,
        or under those of other links.
        """
        if key != self.boat.key:
            self._floors.record(self.boat.key, self.boat.proved)
            self.boat.change_key(key, self._floors.of(key))
            self.stamps.seen = max(one.proved for one in (self.boat, *self._of_files.values()))
        self.stamps.follow(first)
        self._key_saving = self._storage.save(KEY_FILE, b"" if key is None else key.reveal().hex().encode())
        self.is_active = key is not None or bool(self._of_files)
        self._save_ahead()  # the floor of the old key, at once

    def key_saved(self) -> str | None:
        """Result of a change of key, once: "" if stored, or the error; None: no news.

        No news either before the timestamps are stored: until then the report could not be signed.
        """
        self._finish()
        if self._key_saving is None or self._saving is not None or not self._key_saving.is_done():
            return None
        saving, self._key_saving = self._key_saving, None
        return saving.error()

    def tick(self, unix_s: float) -> None:
        """Update the date."""
        if self.is_active:
            self.stamps.clock = timestamp_at(unix_s)
            self._reserve()

    def close(self) -> None:
        """Store the present state before the storage is closed. May be called twice."""
        if not self._is_closed and (self.stamps.last or self.stamps.seen):
            self._save()
        self._is_closed = True

    def _reserve(self) -> None:
        if not self.is_active:
            return
        stamps = self.stamps
        if self._saving is not None:
            self._finish()
        elif stamps.now > stamps.limit - AHEAD // 2 or stamps.last > stamps.limit - _AHEAD_OF_LAST // 2:
            self._save_ahead()

    def _save_ahead(self) -> None:
        """Reserve the next timestamps, and store them with the floors."""
        stamps = self.stamps
        self._reserved = min(max(stamps.now + AHEAD, stamps.last + _AHEAD_OF_LAST), NEVER)
        self._saving = self._save()
        self._finish()

    def _save(self) -> Saving:
        for one in (self.boat, *self._of_files.values()):
            self._floors.record(one.key, one.proved)
        tree = {"first": self._reserved, "seen": self.stamps.seen, "proved": self._floors.to_tree()}
        return self._storage.save(STAMPS_FILE, json.dumps(tree).encode())

    def _finish(self) -> None:
        if self._saving is None or not self._saving.is_done():
            return
        if error := self._saving.error():
            # Continue anyway: a silent boat is worse than repeated timestamps
            logger.error("signing timestamps are not kept over a restart: %s", error)
        self._saving = None
        self.stamps.limit = self._reserved

    def _load_stamps(self) -> tuple[int, int, KeyFloors]:
        content = self._storage.load(STAMPS_FILE)
        loss = self._storage.damage(STAMPS_FILE)
        first, seen, floors = 1, 0, KeyFloors()
        if content:
            try:
                first, seen, floors = _parse_stamps(content)
            except (ValueError, KeyError, TypeError, RecursionError) as error:
                logger.warning("%s ignored: %s", STAMPS_FILE, error)
                loss = f"{STAMPS_FILE} cannot be read, none is in use"
            else:
                # The damaged generation was written when half of this reserve was used
                first = min(max(first, 1) + (AHEAD if loss else 0), NEVER - 1)
        if loss:
            self.losses["signing timestamps"] = loss
        return first, seen, floors

    def _load_key(self) -> SigningKey | None:
        content = self._storage.load(KEY_FILE)
        loss = self._storage.damage(KEY_FILE)
        key = None
        if content:
            try:
                key = parse_key(content)
            except ValueError as error:
                logger.warning("%s ignored: %s", KEY_FILE, error)
                loss = f"{KEY_FILE} cannot be read, none is in use"
        if loss:
            self.losses["signing key"] = loss
        return key


def _parse_stamps(content: bytes) -> tuple[int, int, KeyFloors]:
    tree = json.loads(content)
    first, seen = tree["first"], tree["seen"]
    if not (_is_stamp(first) and _is_stamp(seen)):
        raise ValueError("no timestamps in it")
    return first, seen, KeyFloors.from_tree(tree.get("proved"), seen)


def _is_stamp(value: object) -> bool:
    return isinstance(value, int) and 0 <= value < NEVER
