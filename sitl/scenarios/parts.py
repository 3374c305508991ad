"""Sensors by their class: one key of a layer stands for all figures of the class.

The figures lie below the layer that names the class, so that its own keys, and those of later layers, change
single ones.
"""

from collections.abc import Mapping, Sequence
from typing import Any, Final

from sitl.scenarios.layers import Layer
from sitl.world.sensors.rangers import OF_KIND, RANGERS
from sitl.world.sensors.receivers import OF_CLASS, RECEIVERS

# By table of [sensors] and its key: what each class sets.
CLASSES: Final[Mapping[tuple[str, str], Mapping[str, Mapping[str, Any]]]] = {
    ("gnss", "receiver"): {
        name: {key: getattr(one, key) for key in OF_CLASS} for name, one in RECEIVERS.items()
    },
    ("sonar", "ranger"): {name: {key: getattr(one, key) for key in OF_KIND} for name, one in RANGERS.items()},
}


def with_parts(layers: Sequence[Layer]) -> list[Layer]:
    """The layers, with a further one below each that names the class of a sensor.

    An unknown class is left to the decoder.
    """
    out: list[Layer] = []
    for layer in layers:
        for (table, key), classes in CLASSES.items():
            name = _at(layer.tree, "sensors", table, key)
            if isinstance(name, str) and name in classes:
                out.append(Layer(f"{table} {name}", {"sensors": {table: classes[name]}}))
        out.append(layer)
    return out


def _at(tree: object, *keys: str) -> object:
    for key in keys:
        if not isinstance(tree, Mapping):
            return None
        tree = tree.get(key)
    return tree
