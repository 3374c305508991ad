"""Whether a value fits a parameter, by its type and its description."""

import math

from companion.shore.parameters.metadata import Description
from companion.shore.parameters.values import flaw_of, float_or_int, is_same, write


def refusal_of(name: str, value: float, kind: int, is_bytewise: bool, described: Description) -> str:
    """Why a value is refused, in a sentence; empty if it fits.

    A listed value fits whatever the range. A description without a range allows the listed values only.
    """
    if described.read_only:
        return f"{name} cannot be changed: the boat has it fixed"
    try:
        number = float(value)
    except OverflowError:  # a whole number beyond every float
        number = math.inf
    if flaw := flaw_of(number, kind, is_bytewise):
        return f"{name}: {_written(number)} {flaw}"
    if any(is_same(number, listed) for listed, _ in described.values):
        return ""
    low, high = described.low, described.high
    unit = f" {described.unit}" if described.unit else ""
    below = low is not None and number < low and not is_same(number, low)
    above = high is not None and number > high and not is_same(number, high)
    if below or above:
        least = "−∞" if low is None else _written(low)
        most = "∞" if high is None else _written(high)
        return f"{name}: {_written(number)}{unit} is outside {least} to {most}{unit}"
    if described.values and not described.bits and low is None and high is None:
        listed = ", ".join(_written(one) for one, _ in described.values[:20])
        return f"{name}: {_written(number)} is not one of {listed}"
    return ""


def _written(value: float) -> str:
    if not math.isfinite(value):
        return str(value)
    return write(float_or_int(value, float(value).is_integer() and abs(value) < 1e15))
