"""A campaign's file: what is sailed, what varies, and what must come out.

    title = "Courses in a current"

    [run]                                    # of every run; a list is sailed value by value
    scenario = "open"
    course = ["straight", "zigzag"]          # or mission = "a.plan"; neither: planned on the scenario's map
    seeds = 20                               # how many, counted from first_seed
    settings.environment.current_m_s = 0.5   # as --set says it
    waves = false                            # flat water; else a run draws waves by its seed

    [grid]                                   # every combination of these lists
    environment.current_to_deg = [0, 90, 180, 270]

    [variants.receiver]                      # named bundles of settings, each sailed as well
    standard = {}
    rtk = { sensors.gnss.receiver = "rtk" }

    [sample]                                 # or so many draws: [low, high] or { choose = […] }
    count = 100
    settings.environment.wind_m_s = [0.0, 8.0]

    [[expect]]
    figure = "cross_track_rms_m"
    at_most = 0.15

Scenarios and missions are looked for beside the file. Each draw of a sample has seeds of its own.
"""

import hashlib
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from random import Random
from typing import Annotated, Any, Literal

import msgspec
from msgspec import Meta, field

from companion.config.boat_config import load_toml
from companion.config.section import NonNegative, Positive, Section
from companion.core.errors import ConfigError
from sitl.courses.missions import course_names
from sitl.experiments.campaign.expect import Expectation
from sitl.experiments.campaign.sea_state import draw_waves
from sitl.experiments.trial import Trial
from sitl.scenarios.layers import Layer, decode, merge
from sitl.world.sampling import Seed, generator

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
    """The sample's rows, one value a range.

    The numbers depend on the sample's seed and the setting's name, so that one setting more never changes
    another one's values.
    """
    columns = {name: _drawn(sample, name, range_) for name, range_ in ranges.items()}
    return [{name: values[row] for name, values in columns.items()} for row in range(sample.count)]


def latin_hypercube(random: Random, count: int) -> list[float]:
    """Shares of a range, one in each of `count` equal parts, shuffled (McKay, Beckman, Conover 1979)."""
    order = list(range(count))
    random.shuffle(order)
    return [(stratum + random.random()) / count for stratum in order]


def _drawn(sample: Sample, name: str, range_: Range) -> list[Any]:
    random = generator(sample.seed, f"sample/{name}")
    count = sample.count
    if sample.method == "random":
        shares = [random.random() for _ in range(count)]
    else:
        shares = latin_hypercube(random, count)
    if isinstance(range_, Choice):
        return [range_.choose[int(share * len(range_.choose))] for share in shares]
    low, high = range_
    return [low + share * (high - low) for share in shares]


MOST_RUNS = 1_000_000
Several = str | tuple[str, ...]


class RunTable(Section, frozen=True):
    """What every run has in common. seeds: a number of them, or a list. waves: draw them, by the seed, where
    neither the scenario nor the campaign sets any.
    """

    scenario: Several = "open"
    case: Several = ""
    course: Several = ""
    mission: Several = ""
    seeds: Annotated[int, Meta(ge=1, le=MOST_RUNS)] | Annotated[tuple[Seed, ...], Meta(min_length=1)] = 1
    first_seed: Seed = 1
    timeout_s: Positive | None = None
    linger_s: NonNegative = 0.0  # how long a boat is watched that has ended or left its mission
    fence: bool = False  # upload the outline of the water as one
    waves: bool = True
    settings: dict[str, Any] = field(default_factory=dict)


class File(Section, frozen=True):
    """The whole file. variants: by name, and in each by its choices' names, settings that go together."""

    title: str = ""
    run: RunTable = RunTable()
    variants: dict[str, Annotated[dict[str, dict[str, Any]], Meta(min_length=1)]] = field(
        default_factory=dict
    )
    grid: dict[str, Any] = field(default_factory=dict)
    sample: Sample | None = None
    expect: tuple[Expectation, ...] = ()


@dataclass(frozen=True, slots=True)
class Campaign:
    """A campaign with every run spelt out. fingerprint: of everything the runs depend on but the program."""

    title: str
    source: str
    runs: tuple[Trial, ...]
    expect: tuple[Expectation, ...]
    fingerprint: str

    @property
    def factors(self) -> tuple[str, ...]:
        """The settings that vary."""
        return tuple(self.runs[0].factors) if self.runs else ()


def load_campaign(path: Path) -> Campaign:
    """Read a campaign's file.

    Raises ConfigError: it cannot be used; names the file, the key and what was expected.
    """
    name = str(path)
    file = decode([Layer(name, load_toml(path))], File)
    runs = tuple(_runs(file, path))
    return Campaign(
        title=file.title or path.stem,
        source=name,
        runs=runs,
        expect=file.expect,
        fingerprint=_fingerprint(runs),
    )


def _runs(file: File, path: Path) -> Iterator[Trial]:
    table, name = file.run, str(path)
    for course in _each(table.course):
        if course and course not in course_names():
            raise ConfigError(
                f"{name}: run.course: no course {course!r}: expected {', '.join(course_names())}"
            )
    if table.course and table.mission:
        raise ConfigError(f"{name}: run.mission: a run sails either a course or a mission")
    grid = {key: _listed(values, f"{name}: grid.{key}") for key, values in leaves(file.grid)}
    draws: list[Row] = [{}]
    if file.sample is not None:
        ranges = {
            key: _range(value, f"{name}: sample.settings.{key}")
            for key, value in leaves(file.sample.settings, {"choose"})
        }
        draws = sample_rows(file.sample, ranges)
    seeds = (
        table.seeds
        if isinstance(table.seeds, tuple)
        else tuple(range(table.first_seed, table.first_seed + table.seeds))
    )
    stride = max(seeds) - min(seeds) + 1
    voyages = list(product(*map(_each, (table.scenario, table.case, table.course, table.mission))))
    lists = [*grid.values(), *file.variants.values(), draws, seeds, voyages]
    if (count := math.prod(map(len, lists))) > MOST_RUNS:
        raise ConfigError(f"{name}: {count} runs are more than {MOST_RUNS}")
    settings = [
        ({**chosen, **factors}, merge([Layer(name, tree) for tree in (table.settings, *bundles, *trees)]))
        for chosen in grid_rows({variant: tuple(choices) for variant, choices in file.variants.items()})
        for bundles in [[file.variants[variant][choice] for variant, choice in chosen.items()]]
        for row in grid_rows(grid)
        for factors in ({**row, **draw} for draw in draws)
        for trees in [[_tree(*factor) for factor in factors.items()]]
    ]
    for number, ((scenario, case, course, mission), (n, (factors, tree)), seed) in enumerate(
        product(voyages, enumerate(settings), seeds), 1
    ):
        yield Trial(
            number=number,
            scenario=_beside(path, scenario),
            seed=seed + n % len(draws) * stride,
            case=case,
            course=course,
            mission=str(path.parent / mission) if mission else "",
            settings=tree,
            factors=factors,
            below=draw_waves(seed + n % len(draws) * stride) if table.waves and not _has_waves(tree) else {},
            timeout_s=table.timeout_s,
            linger_s=table.linger_s,
            fence=table.fence,
            source=name,
        )


def _has_waves(tree: Mapping[str, Any]) -> bool:
    environment = tree.get("environment")
    return isinstance(environment, Mapping) and "wave_height_m" in environment


def _each(value: Several) -> tuple[str, ...]:
    return (value,) if isinstance(value, str) else value


def _beside(path: Path, scenario: str) -> str:
    """A scenario's file lies beside the campaign's; an installed one goes by its name."""
    return (
        str(path.parent / scenario) if Path(scenario).suffix in (".toml", ".geojson", ".json") else scenario
    )


def leaves(
    tree: Mapping[str, Any], ends: frozenset[str] | set[str] = frozenset()
) -> Iterator[tuple[str, Any]]:
    """Every value of nested tables by its dotted name. A table with one of `ends` in it is a value, too."""
    for key, value in tree.items():
        if isinstance(value, Mapping) and not ends & value.keys():
            yield from ((f"{key}.{below}", leaf) for below, leaf in leaves(value, ends))
        else:
            yield key, value


def _tree(key: str, value: object) -> dict[str, Any]:
    first, _, rest = key.partition(".")
    return {first: _tree(rest, value) if rest else value}


def _listed(values: object, where: str) -> Sequence[Any]:
    if not isinstance(values, list) or not values:
        raise ConfigError(f"{where}: expected a list of values, such as [0.0, 0.5]")
    return values


def _range(value: object, where: str) -> tuple[float, float] | Choice:
    try:
        range_ = msgspec.convert(value, tuple[float, float] | Choice)
    except msgspec.ValidationError:
        raise ConfigError(f"{where}: expected [low, high] or {{ choose = […] }}") from None
    if isinstance(range_, tuple) and not range_[0] <= range_[1]:
        raise ConfigError(f"{where}: {list(range_)}: the low end comes first")
    return range_


def _fingerprint(runs: Sequence[Trial]) -> str:
    """SHA-256 over the runs and the files that they name."""
    digest = hashlib.sha256()
    for run in runs:
        digest.update(msgspec.json.encode(run, order="deterministic"))
    for name in sorted({name for run in runs for name in (run.scenario, run.mission)}):
        path = Path(name)
        if path.suffix and path.is_file():
            digest.update(path.read_bytes())
    return digest.hexdigest()
