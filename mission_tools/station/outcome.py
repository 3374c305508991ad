"""How a request to a boat ends. Whatever decides on the end asks for its type, never for its text."""

from collections.abc import Callable
from dataclasses import dataclass

from mission_tools.station.words import say


@dataclass(frozen=True, slots=True)
class Accepted:
    """The boat does it, or holds it. text: for people."""

    text: str


@dataclass(frozen=True, slots=True)
class Refused:
    """The boat, or this station, does not. text: why."""

    text: str


@dataclass(frozen=True, slots=True)
class Silent:
    """The boat has not answered: it may have done it."""

    text: str = say("answer.none")


@dataclass(frozen=True, slots=True)
class Cancelled:
    """A newer request has taken its place."""

    text: str = say("answer.replaced")


Outcome = Accepted | Refused | Silent | Cancelled
Answered = Callable[[Outcome], None]
