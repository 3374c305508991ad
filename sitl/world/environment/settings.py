"""The scenario's table [environment]."""

import math
from pathlib import Path
from typing import Annotated, Literal, Self

from msgspec import Meta, structs

from companion.config.section import NonNegative, Positive, Section, Share

East_North = tuple[float, float]


class River(Section, frozen=True):
    """A straight channel through a point [east, north]; speed_m_s on its middle line, none at its banks."""

    speed_m_s: NonNegative
    width_m: Positive
    through: East_North = (0.0, 0.0)
    to_deg: float = 90.0


class Gyre(Section, frozen=True):
    """A round eddy about a centre [east, north], fastest (speed_m_s) at radius_m."""

    speed_m_s: NonNegative
    radius_m: Positive
    centre: East_North = (0.0, 0.0)
    clockwise: bool = True


class Tide(Section, frozen=True):
    """A stream to and fro, strongest towards to_deg at strongest_s, and again every period_s."""

    speed_m_s: NonNegative
    to_deg: float = 90.0
    period_s: Positive = 44_714.0
    strongest_s: float = 0.0


class Bump(Section, frozen=True):
    """A round hole about [east, north], or a hump with a negative deeper_m; its profile is a Gaussian."""

    centre: East_North
    deeper_m: float
    radius_m: Positive


class Stream(Section, frozen=True):
    """The bed of an old stream through points [east, north]."""

    through: Annotated[tuple[East_North, ...], Meta(min_length=2)]
    deeper_m: float = 0.8
    width_m: Positive = 10.0


class Bottom(Section, frozen=True):
    """The bottom between the shores: slope (even), analytic (with bumps and a stream), fractal (these, and
    roughness), or geotiff (positive depths in a file beside the scenario, in its frame or by an EPSG code).

    roughness_m: standard deviation; hurst: 0 rugged to 1 smooth; longest_m: of its waves. Weed covers
    weed_share of the water in patches of weed_patch_m. Raises ValueError: a geotiff without a file.
    """

    kind: Literal["slope", "analytic", "fractal", "geotiff"] = "slope"
    bumps: tuple[Bump, ...] = ()
    stream: Stream | None = None
    file: str = ""
    seed: Annotated[int, Meta(ge=0)] = 1
    roughness_m: NonNegative = 0.3
    # Profiles of the sea floor have 0.8 to 1 (J. A. Goff and T. H. Jordan, J. Geophys. Res. 93, 1988)
    hurst: Share = 0.9
    longest_m: Positive = 60.0
    weed_share: Share = 0.0
    weed_height_m: Positive = 0.5
    weed_patch_m: Positive = 20.0
    cell_m: Annotated[float, Meta(ge=0.1)] = 1.0

    def __post_init__(self) -> None:
        super().__post_init__()
        if (self.kind == "geotiff") is not bool(self.file):
            raise ValueError(f"file = {self.file!r}: expected a GeoTIFF with kind = 'geotiff', else none")


class Environment(Section, frozen=True):
    """Current, wind and waves. All of it acts whether the boat is armed or not.

    A current flows *to*, wind and waves come *from*, as sailors say; degrees clockwise from north. The
    uniform current, river, gyre, tide and what current_file (beside the scenario; see
    `sitl.world.environment.current`) holds are summed.

    wind_m_s is the mean at the hull's height, which over water is two thirds of what a forecast gives for
    10 m. gust_m_s is what the gusts peak at within ten minutes, 0 for a wind without any; gust_s is their
    correlation time. wave_height_m is the significant height, wave_period_s the period of the highest
    waves.

    shore_hold_n is the force with which a soft shore holds a grounded hull; 0 is a hard wall. The bottom
    slopes down by shore_slope from every shore to depth_m. The depth acts on the depth sounder only. Raises
    ValueError: gusts that are weaker than the mean wind, or waves that are too steep to stand.
    """

    current_m_s: NonNegative = 0.0
    current_to_deg: float = 0.0
    river: River | None = None
    gyre: Gyre | None = None
    tide: Tide | None = None
    current_file: str = ""
    wind_m_s: NonNegative = 0.0
    wind_from_deg: float = 0.0
    gust_m_s: NonNegative = 0.0
    gust_s: Positive = 4.0
    wave_height_m: NonNegative = 0.0
    wave_period_s: Positive = 2.0
    wave_from_deg: float = 0.0
    shore_hold_n: NonNegative = 0.0
    depth_m: Positive = 5.0
    shore_slope: Positive = 0.2
    bottom: Bottom = Bottom()

    def __post_init__(self) -> None:
        super().__post_init__()
        if 0.0 < self.gust_m_s < self.wind_m_s:
            raise ValueError(
                f"gust_m_s = {self.gust_m_s:g}: expected at least wind_m_s = {self.wind_m_s:g}, or 0 for none"
            )
        highest_m = 0.1 * self.wave_period_s * self.wave_period_s  # a steepness of one in sixteen
        if self.wave_height_m > highest_m:
            raise ValueError(
                f"wave_height_m = {self.wave_height_m:g}: expected at most {highest_m:g} with waves of"
                f" {self.wave_period_s:g} s: higher ones break"
            )

    def beside(self, folder: Path) -> Self:
        """The same with its files looked for in a folder, unless they say where they are."""
        current_file, bottom = self.current_file and str(folder / self.current_file), self.bottom
        if bottom.file:
            bottom = structs.replace(bottom, file=str(folder / bottom.file))
        return structs.replace(self, current_file=current_file, bottom=bottom)

    @property
    def current_north_m_s(self) -> float:
        """The uniform current's northward part."""
        return self.current_m_s * math.cos(math.radians(self.current_to_deg))

    @property
    def current_east_m_s(self) -> float:
        """The uniform current's eastward part."""
        return self.current_m_s * math.sin(math.radians(self.current_to_deg))
