"""Settings in layers: a boat's file, a scenario's file over it, the command line on top.

The layers are merged into one tree and decoded at once; an error still names the layer that holds the key.
"""

import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

import msgspec

from companion.core.errors import ConfigError
from companion.core.toml_text import parse_toml

T = TypeVar("T")
COMMAND_LINE = "--set"
_MOST_PARTS = 16  # of a key
_LONGEST_TOLD = 40  # characters of a value that cannot be used


@dataclass(frozen=True, slots=True)
class Layer:
    """One source of settings: what to call it in an error, and its tree."""

    name: str
    tree: Mapping[str, Any]


def parse_overrides(overrides: Sequence[str]) -> Layer:
    """Settings from the command line, such as `environment.current_m_s=0.5`.

    The value is read as TOML; what is not TOML is taken as a string, so that `boat.model=pool` needs no
    quotes. Raises ConfigError: no `=`, an empty part in the key, or a key below another that has a value.
    """
    tree: dict[str, Any] = {}
    for override in overrides:
        key, equals, text = override.partition("=")
        parts = [part.strip() for part in key.split(".")]
        if not equals or not all(parts) or len(parts) > _MOST_PARTS:
            raise ConfigError(
                f"{COMMAND_LINE} {override}: expected KEY=VALUE, such as environment.current_m_s=0.5"
            )
        table = tree
        for part in parts[:-1]:
            table = table.setdefault(part, {})
            if not isinstance(table, dict):
                raise ConfigError(f"{COMMAND_LINE} {override}: {part} already has a value of its own")
        table[parts[-1]] = _parse_value(text.strip())
    return Layer(COMMAND_LINE, tree)


def _parse_value(text: str) -> object:
    try:
        return parse_toml(f"value = {text}")["value"]
    except tomllib.TOMLDecodeError:
        return text
    except ValueError as error:
        raise ConfigError(f"{COMMAND_LINE}: {text[:_LONGEST_TOLD]}…: {error}") from None


def merge(layers: Sequence[Layer]) -> dict[str, Any]:
    """One tree: tables are joined key by key, anything else is replaced by the later layer."""
    merged: dict[str, Any] = {}
    for layer in layers:
        merged = _joined(merged, layer.tree)
    return merged


def _joined(below: Mapping[str, Any], above: Mapping[str, Any]) -> dict[str, Any]:
    out = dict(below)
    for key, value in above.items():
        under = out.get(key)
        out[key] = (
            _joined(under, value) if isinstance(under, Mapping) and isinstance(value, Mapping) else value
        )
    return out


def decode(layers: Sequence[Layer], type_: type[T]) -> T:
    """Merge the layers and decode the result.

    Raises ConfigError: names the layer, the key and what was expected there.
    """
    tree = merge(layers)
    try:
        return msgspec.convert(tree, type_)
    except msgspec.ValidationError as error:
        raise ConfigError(explain(str(error), layers)) from None


def explain(message: str, layers: Sequence[Layer], root: str = "") -> str:
    """msgspec's message as `layer: key: what was expected`, root being the key under which it was decoded."""
    what, _, where = message.partition(" - at `$")
    keys = [key for key in (root + where.rstrip("`")).replace("[", ".").replace("]", "").split(".") if key]
    what = what.replace("`", "")
    unknown = "Object contains unknown field "
    if what.startswith(unknown):
        keys.append(what.removeprefix(unknown))
        what = "no such setting"
    for layer in reversed(layers):
        if _holds(layer.tree, keys):
            return f"{layer.name}: {'.'.join(keys)}: {what}"
    return f"{layers[-1].name}: {'.'.join(keys)}: {what}" if keys else f"{layers[-1].name}: {what}"


def _holds(tree: object, keys: Sequence[str]) -> bool:
    for key in keys:
        if isinstance(tree, Mapping) and key in tree:
            tree = tree[key]
        elif isinstance(tree, list) and key.isdecimal() and int(key) < len(tree):
            tree = tree[int(key)]
        else:
            return False
    return True
