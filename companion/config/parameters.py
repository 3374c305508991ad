"""MAVLink parameters: rows over the configuration tree.

One table (`parameter_table.py`) lists all parameters. A row stands for a field of the configuration, scaled
where Rover's unit differs, or exists for ground stations only: a constant that QGroundControl requires, or a
value that it writes and reads back. Names are ArduPilot Rover's where the meaning is the same.

Values that differ from their defaults are stored as text, one `NAME VALUE` per line, which QGroundControl,
MAVProxy and Mission Planner read as a parameter file.
"""

import logging
import math
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from enum import IntEnum
from operator import attrgetter
from typing import NamedTuple

from companion.config.boat_config import BoatConfig, with_value
from companion.config.parameter_values import Names
from companion.core.errors import ConfigError
from companion.core.storage import Saving, Storage
from companion.core.units import LARGEST, as_float32, shortest

logger = logging.getLogger(__name__)

PARAMETER_FILE = "params.parm"
_LONGEST_TOLD = 40  # characters quoted of an unreadable line


class ParameterType(IntEnum):
    """MAV_PARAM_TYPE, as far as used."""

    INT8 = 2
    INT16 = 4
    INT32 = 6
    REAL32 = 9


@dataclass(frozen=True, slots=True)
class Choice:
    """A parameter that selects one value of a field: it is `value` while the field is `setting`, else 0."""

    setting: int
    value: int


@dataclass(frozen=True, slots=True)
class ParameterRow:
    """One parameter. `path`: a field of the configuration; without one the row keeps its own value.

    value = field × scale. read_only rows are documented constants. values: the allowed values of an
    enumeration. bits: of a bit mask. decimals: shown by stations for a REAL32. needs_restart: effective from
    the next start.
    """

    name: str
    kind: ParameterType
    text: str
    path: str = ""
    default: float = 0.0
    scale: float = 1.0
    unit: str = ""
    low: float = -math.inf
    high: float = math.inf
    read_only: bool = False
    values: Names = ()
    bits: Names = ()
    decimals: int = 3
    needs_restart: bool = False
    choice: Choice | None = None

    def __post_init__(self) -> None:
        if not 0 < len(self.name) <= 16:
            raise ConfigError(f"parameter name {self.name!r} must have 1 to 16 characters")


@dataclass(frozen=True, slots=True)
class ParameterHook:
    """A parameter outside the configuration: `apply` is called with each new value."""

    row: ParameterRow
    apply: Callable[[float], None]


class Stored(NamedTuple):
    """A finished save. values: as saved; counts: changes of each; error: why it failed, or empty."""

    values: dict[str, float]
    counts: Counter[str]
    error: str


class Parameters:
    """The live values: a frozen configuration, replaced at each change, and rows without a field."""

    def __init__(
        self,
        config: BoatConfig,
        rows: tuple[ParameterRow, ...],
        storage: Storage,
        parameter_hooks: Sequence[ParameterHook] = (),
    ) -> None:
        """parameter_hooks: further parameters of the hardware; they replace rows of the same name."""
        if parameter_hooks:
            by_name = {row.name: row for row in (*rows, *(hook.row for hook in parameter_hooks))}
            rows = tuple(sorted(by_name.values(), key=lambda row: row.name))
        self.config = config
        self.rows = rows
        self._hooks = {hook.row.name: hook.apply for hook in parameter_hooks}
        self._storage = storage
        self._index = {row.name: index for index, row in enumerate(rows)}
        self._kept = {row.name: row.default for row in rows if not row.path}
        self.loss = ""  # what stored values are lost, and what is used instead
        self._savings: list[tuple[Saving, dict[str, float], Counter[str]]] = []  # oldest first; see Stored
        self._defaults = [self.value(row) for row in rows]
        self._load()

    def index_of(self, name: str) -> int | None:
        """Index of a parameter, or None."""
        return self._index.get(name)

    def sharing(self, name: str) -> list[int]:
        """Indexes of this parameter and of the others over the same field."""
        path = self.rows[self._index[name]].path if name in self._index else ""
        return [
            index for index, row in enumerate(self.rows) if row.name == name or (path and row.path == path)
        ]

    def value(self, row: ParameterRow) -> float:
        """The value as stations see it: a whole number or a 32-bit float."""
        if not row.path:
            return as_float32(self._kept[row.name])
        if row.choice is not None:
            is_chosen = attrgetter(row.path)(self.config) == row.choice.setting
            return float(row.choice.value) if is_chosen else 0.0
        value = float(attrgetter(row.path)(self.config)) * row.scale
        return as_float32(value if row.kind is ParameterType.REAL32 else round(value))

    def default(self, row: ParameterRow) -> float:
        """The value of the configuration file."""
        return self._defaults[self._index[row.name]]

    def set(self, name: str, value: float) -> str:
        """Change a parameter and start saving it. Returns the reason for a refusal, or an empty string."""
        reason = self._change(name, value)
        if not reason:
            self._save([self.rows[index].name for index in self.sharing(name)])
        return reason

    def set_many(self, values: Iterable[tuple[str, float]]) -> list[str]:
        """Change several with one save; unknown names are ignored. Returns the reasons for refusals."""
        before = self._values()
        reasons = [self._change(name, value) for name, value in values if name in self._index]
        self._save(self._changed_since(before))
        return [reason for reason in reasons if reason]

    def reset(self) -> None:
        """Restore and save the defaults."""
        before = self._values()
        for row, default in zip(self.rows, self._defaults, strict=True):
            if not row.read_only and self.value(row) != default:
                self._change(row.name, default)
        self._save(self._changed_since(before))

    def is_unsaved(self, name: str) -> bool:
        """Whether the present value is not yet stored; `poll_saves` will report it."""
        return any(name in values and not saving.is_done() for saving, values, _ in self._savings)

    @property
    def is_saving(self) -> bool:
        """Whether `poll_saves` has something to report."""
        return bool(self._savings)

    def poll_saves(self) -> list[Stored]:
        """The saves that have finished since the last call. Call it every tick while there are some."""
        ended: list[Stored] = []
        while self._savings and self._savings[0][0].is_done():
            saving, values, counts = self._savings.pop(0)
            ended.append(Stored(values, counts, saving.error()))
        return ended

    def _values(self) -> list[float]:
        return [self.value(row) for row in self.rows]

    def _changed_since(self, before: list[float]) -> list[str]:
        return [
            row.name for row, old, new in zip(self.rows, before, self._values(), strict=True) if new != old
        ]

    def _change(self, name: str, value: float) -> str:
        index = self._index.get(name)
        if index is None:
            return f"{name}: no such parameter"
        row = self.rows[index]
        if row.read_only:
            return "" if value == self.value(row) else f"{name} is fixed at {self.value(row):g}"
        if not abs(value) <= LARGEST:
            return f"{name}: not a number that fits 32 bits"
        if not row.low <= value <= row.high:
            return f"{name}: {value:g} is outside {row.low:g}..{row.high:g}"
        if row.kind is not ParameterType.REAL32:
            value = float(round(value))
        if row.values and value not in [number for number, _ in row.values]:
            return f"{name}: {value:g} is not one of {', '.join(str(number) for number, _ in row.values)}"
        if not row.path:
            self._kept[name] = value
            if name in self._hooks:
                self._hooks[name](value)
            return ""
        try:
            self.config = with_value(self.config, row.path, self._field_value(row, value))
        except ConfigError as error:
            return f"{name}: {error}"
        return ""

    def _field_value(self, row: ParameterRow, value: float) -> object:
        current = attrgetter(row.path)(self.config)
        if row.choice is not None:
            if value != 0.0:
                return row.choice.setting
            return 0 if current == row.choice.setting else current
        if isinstance(current, bool):
            return value != 0.0
        if isinstance(current, int):
            return round(value / row.scale)
        # 0.1 arrives as 0.10000000149: use the shortest decimal with the same 32 bits
        return float(shortest(value)) / row.scale

    def _save(self, names: list[str]) -> None:
        lines = [
            f"{row.name} {shortest(self.value(row))}"
            for row, default in zip(self.rows, self._defaults, strict=True)
            if self.value(row) != default
        ]
        saving = self._storage.save(PARAMETER_FILE, ("\n".join(lines) + "\n").encode())
        if not self._savings or self._savings[-1][0] is not saving:  # otherwise one write covers both
            self._savings.append((saving, {}, Counter()))
        _, values, counts = self._savings[-1]
        values.update({name: self.value(self.rows[self._index[name]]) for name in names})
        counts.update(names)

    def _load(self) -> None:
        content = self._storage.load(PARAMETER_FILE)
        self.loss = self._storage.damage(PARAMETER_FILE)
        refused: list[str] = []
        for number, line in enumerate(content.decode(errors="replace").splitlines(), 1):
            words = line.replace(",", " ").split()
            if not words or words[0].startswith("#"):
                continue
            try:
                reason = self._change(words[0], float(words[1]))
            except (IndexError, ValueError):
                reason = f"{line[:_LONGEST_TOLD]!r} is not 'NAME VALUE'"
            if reason:
                logger.warning("%s line %d ignored: %s", PARAMETER_FILE, number, reason)
                refused.append(reason)
        if refused and not self.loss:
            more = f", and {len(refused) - 1} more" if len(refused) > 1 else ""
            self.loss = f"in {PARAMETER_FILE}, {refused[0]}{more}; the defaults are in use"
