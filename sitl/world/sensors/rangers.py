"""Kinds of rangers, and the settings of one.

What it hears follows the sonar equation (R. J. Urick, *Principles of Underwater Sound*, 3rd ed. 1983,
chapters 2 and 12), here in air.

With R the range at which half of the pings return from a wide plane that is met squarely, the echo of a body
at range r, met θ off the axis of a beam of width w, exceeds the threshold by

    E = 20 log(R / r) + 2 α (R − r) + 10 log(a / (a + r)) − 6 (2 θ / w)²      dB

The first two terms are spreading and absorption of an echo by a mirror. The third is what a vertical
cylinder of radius a sends back of that, by geometrical acoustics; a plane has 0. The last is a beam whose
width is that between its half-power points, there and back. Light scatters off dull bodies of any radius
alike and has no third term. A ping is heard if E exceeds a normal number of deviation scatter_db: the level
of a sum of many reflections (Rayleigh) has 5.6 dB.
"""

from collections.abc import Mapping
from typing import Annotated, Final, Literal

from msgspec import Meta

from companion.config.section import NonNegative, Positive, Section, Share

Ranger = Literal["hcsr04", "jsnsr04t", "a02yyuw", "tfmini", "ideal"]


class SonarSettings(Section, frozen=True):
    """A ranger on a servo that sweeps to and fro over sweep_deg about the bow, height_m above the water.

    ranger: its kind, which sets the keys of RANGERS; a scenario, or `--set`, may change single ones. cone_deg
    is w, half_range_m is R and loss_db_m is α above. min_range_m and max_range_m are what its driver states;
    it hears nothing farther, and does not know how far it hears a thing. noise_m is that of a range.
    ghost_share of the pings hear an echo by a detour, or of an earlier ping: a range where nothing is.

    A surface that is met at more than specular_deg from square throws the sound away like a mirror: smooth
    walls from about 30°, stones and reeds hardly ever (90 loses nothing). spray_per_m is the share of pings
    ahead that meet spray of the bow, per metre of wave height.

    The servo is told a bearing with each ping and starts for it servo_dead_s later, at servo_deg_s; the ping
    goes where the servo is, and its reading says where it was told to be.
    """

    fitted: bool = True
    ranger: Ranger = "hcsr04"
    sweep_deg: Annotated[float, Meta(ge=0.0, le=360.0)] = 180.0
    step_deg: Annotated[float, Meta(ge=0.1, le=360.0)] = 15.0
    height_m: NonNegative = 0.15
    # HC-SR04: "measuring angle 15°, 2 to 400 cm", to be used with targets of half a square metre and more
    ping_s: Positive = 0.06  # its user guide's shortest cycle
    cone_deg: Annotated[float, Meta(ge=0.0, le=90.0)] = 15.0
    min_range_m: NonNegative = 0.02
    max_range_m: Positive = 4.0
    half_range_m: Positive = 4.0
    loss_db_m: NonNegative = 1.3  # ISO 9613-1: 40 kHz, 20 °C, 50 % humidity
    scatter_db: NonNegative = 5.6
    noise_m: NonNegative = 0.01  # its user guide: 3 mm; the rest is the driver's timing
    ghost_share: Share = 0.005
    is_light: bool = False
    specular_deg: Annotated[float, Meta(gt=0.0, le=90.0)] = 90.0
    spray_per_m: NonNegative = 0.0
    servo_dead_s: NonNegative = 0.03
    servo_deg_s: Positive = 450.0


# JSN-SR04T: 0.25 to 4.5 m, one transducer that rings for its blind range, directivity 75° ± 10° at −6 dB,
# which is 53° at half power. A02YYUW: 3 to 450 cm on a plane, 60° (DFRobot SEN0311), taken as −6 dB; it
# processes its readings and sends ten a second. TFmini: 12 m on white (90 %) in a room, 7 m outdoors, of
# which ArduPilot's wiki advises to use 6 m; its receiver sees 2.3°, the Plus 3.6°.
# "ideal" hears whatever is in 15° and 4 m, but not the water, as no part does: for tests and figures of the
# planner alone.
RANGERS: Final[Mapping[str, SonarSettings]] = {
    one.ranger: one
    for one in (
        SonarSettings(),
        SonarSettings(
            ranger="jsnsr04t", ping_s=0.1, cone_deg=53.0, min_range_m=0.25, max_range_m=4.5, half_range_m=4.5,
            ghost_share=0.01,
        ),
        SonarSettings(
            ranger="a02yyuw", ping_s=0.1, cone_deg=42.0, min_range_m=0.03, max_range_m=4.5, half_range_m=4.5,
            ghost_share=0.002,
        ),
        SonarSettings(
            ranger="tfmini", ping_s=0.02, cone_deg=3.6, min_range_m=0.1, max_range_m=12.0, half_range_m=7.0,
            loss_db_m=0.0, scatter_db=3.0, noise_m=0.03, ghost_share=0.001, is_light=True,
        ),
        SonarSettings(
            ranger="ideal", cone_deg=10.0, half_range_m=100.0, loss_db_m=0.0, scatter_db=0.0, is_light=True
        ),
    )
}  # fmt: skip
OF_KIND: Final = (  # the keys that a kind sets
    "ping_s", "cone_deg", "min_range_m", "max_range_m", "half_range_m", "loss_db_m", "scatter_db", "noise_m",
    "ghost_share", "is_light",
)  # fmt: skip
