"""Whether a value fits a parameter, by its type and its description."""

import math

from mission_tools.station.parameters.metadata import Description
from mission_tools.station.parameters.values import flaw_of, float_or_int, is_same, write
from mission_tools.station.words import say


def refusal_of(name: str, value: float, kind: int, is_bytewise: bool, described: Description) -> str:
    """Why a value is refused, in a sentence; empty if it fits.

    A listed value fits whatever the range. A description without a range allows the listed values only.
    """
    if described.read_only:
        return say("answer.param_fixed", name=name)
    try:
        number = float(value)
    except OverflowError:  # a whole number beyond every float
        number = math.inf
    if flaw := flaw_of(number, kind, is_bytewise):
        return say("answer.param_flaw", name=name, value=_written(number), flaw=flaw)
    if any(is_same(number, listed) for listed, _ in described.values):
        return ""
    low, high = described.low, described.high
    unit = f" {described.unit}" if described.unit else ""
    below = low is not None and number < low and not is_same(number, low)
    above = high is not None and number > high and not is_same(number, high)
    if below or above:
        least = "−∞" if low is None else _written(low)
        most = "∞" if high is None else _written(high)
        return say(
            "answer.param_outside", name=name, value=_written(number) + unit, least=least, most=most + unit
        )
    if described.values and not described.bits and low is None and high is None:
        listed = ", ".join(_written(one) for one, _ in described.values[:20])
        return say("answer.param_not_listed", name=name, value=_written(number), listed=listed)
    return ""


def _written(value: float) -> str:
    if not math.isfinite(value):
        return str(value)
    return write(float_or_int(value, float(value).is_integer() and abs(value) < 1e15))
