"""Which settings the runs of a campaign have: every combination of a grid, or a sample of a range.

A sample is drawn by Latin hypercube: each setting's range is cut into as many equal shares as there are rows,
and each share is met once (McKay, Beckman, Conover 1979), or plainly at random. The numbers depend on the
sample's own seed and the setting's name, so that one setting more never changes another one's values.
"""

from collections.abc import Iterator, Mapping, Sequence
from itertools import product
from typing import Annotated, Any, Literal

from msgspec import Meta, field

from companion.config.section import Section
from sitl.world.sensors.sampling import Seed, generator

Row = dict[str, Any]


class Choice(Section, frozen=True):
    """Values to choose from, each as often as the next."""

    choose: Annotated[tuple[Any, ...], Meta(min_length=1)]


Range = tuple[float, float] | Choice


class Sample(Section, frozen=True):
    """So many rows of settings, each drawn from its range [low, high] or from a list."""

    count: Annotated[int, Meta(ge=1, le=1_000_000)]
    seed: Seed = 1
    method: Literal["latin_hypercube", "random"] = "latin_hypercube"
    settings: dict[str, Any] = field(default_factory=dict)


def grid_rows(grid: Mapping[str, Sequence[Any]]) -> Iterator[Row]:
    """Every combination, the last setting changing fastest; one empty row for an empty grid."""
    for values in product(*grid.values()):
        yield dict(zip(grid, values, strict=True))


def sample_rows(sample: Sample, ranges: Mapping[str, Range]) -> list[Row]:
    """The sample's rows, one value a range."""
    columns = {name: _drawn(sample, name, range_) for name, range_ in ranges.items()}
    return [{name: values[row] for name, values in columns.items()} for row in range(sample.count)]


def _drawn(sample: Sample, name: str, range_: Range) -> list[Any]:
    random = generator(sample.seed, f"sample/{name}")
    count = sample.count
    if sample.method == "random":
        shares = [random.random() for _ in range(count)]
    else:
        order = list(range(count))
        random.shuffle(order)
        shares = [(stratum + random.random()) / count for stratum in order]
    if isinstance(range_, Choice):
        return [range_.choose[int(share * len(range_.choose))] for share in shares]
    low, high = range_
    return [low + share * (high - low) for share in shares]
