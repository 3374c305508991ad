"""Converts NMEA 0183 sentences of a depth sounder to soundings (v4.11: DPT, DBT, MTW)."""

import math
from typing import Final

from companion.core.readings import DepthReading
from companion.sensors.nmea.sentences import Sentence

DEPTH_SENTENCES: Final = frozenset({"DPT", "DBT", "MTW"})

_PRECEDENCE_S: Final = 2.0
_TEMPERATURE_LIFE_S: Final = 10.0
_FOOT_M: Final = 0.3048
_FATHOM_M: Final = 1.8288


class DepthAssembler:
    """Converts sentences to readings. DPT suppresses DBT for 2 s: many sounders send both.

    transducer_m: depth of the transducer; 0: the offset of DPT, where that is to the surface (positive).
    """

    def __init__(self, transducer_m: float, min_range_m: float, max_range_m: float) -> None:
        self._transducer_m = transducer_m
        self._range_m = min_range_m, max_range_m
        self._dpt_s = -math.inf
        self._temperature_c: float | None = None
        self._temperature_s = -math.inf

    def feed(self, sentence: Sentence, time_s: float) -> DepthReading | None:
        """Process a sentence received at time_s; None if it gives no sounding."""
        transducer_m = self._transducer_m
        match sentence.kind:
            case "MTW":
                self._temperature_c, self._temperature_s = sentence.number("temp"), time_s
                return None
            case "DPT":
                self._dpt_s = time_s
                depth_m = sentence.number("depth")
                transducer_m = transducer_m or max(sentence.number("offset") or 0.0, 0.0)
            case "DBT" if time_s - self._dpt_s >= _PRECEDENCE_S:
                depth_m = _below_transducer_m(sentence)
            case _:
                return None
        min_m, max_m = self._range_m
        if depth_m is not None and not 0.0 < depth_m <= max_m:
            depth_m = None  # zero is what many sounders send without a bottom
        is_warm = time_s - self._temperature_s <= _TEMPERATURE_LIFE_S
        temperature_c = self._temperature_c if is_warm else None
        return DepthReading(time_s, depth_m, temperature_c, transducer_m, min_m, max_m)


def _below_transducer_m(sentence: Sentence) -> float | None:
    for name, unit_m in (("depthm", 1.0), ("depthf", _FOOT_M), ("depthfath", _FATHOM_M)):
        if (depth := sentence.number(name)) is not None:
            return depth * unit_m
    return None
