"""A boat with one payload of every kind, and the outputs that the emulator records."""

from boat_rig import Rig

from companion.payload.payloads import Payloads
from sitl.world.payload import SimOutput, SimPayload

PAYLOAD = """vehicle.payload=[
{kind="relay", number=0, pin=17, name="pump"},
{kind="light", number=1, pin=27, on_link_loss="on"},
{kind="horn", number=2, pin=22, max_on_s=2.0},
{kind="servo", number=9, name="bait", signal={min_us=1000, max_us=2000}},
{kind="gripper", number=1},
{kind="winch", number=1, line_m=5.0, speed_m_s=0.5},
{kind="command", number=7, name="sample", run=["/usr/local/bin/sample"], relay=15},
]""".replace("\n", " ")
CAMERA = 'vehicle.camera={capture=["/usr/bin/rpicam-still"], rtsp="rtsp://10.0.0.2:8554/bow"}'
PUMP, LIGHT, HORN, BAIT, GRIPPER, WINCH, SAMPLE = range(7)


class PayloadRig(Rig):
    """Its payload is `sim`."""

    def __init__(
        self, source: str = "open", *settings: str, has_camera: bool = True, **options: object
    ) -> None:
        camera = (CAMERA,) if has_camera else ()
        super().__init__(source, PAYLOAD, *camera, *settings, **options)  # type: ignore[arg-type]

    @property
    def sim(self) -> SimPayload:
        """The emulated payload."""
        return self.world.electronics.payload

    @property
    def units(self) -> Payloads:
        """The boat's side of it."""
        return self.boat.payload.units

    def output(self, index: int) -> SimOutput:
        """An output by its table."""
        return self.sim.outputs[index]

    def values(self, index: int) -> list[float]:
        """All values that an output was given."""
        return [one.value for one in self.output(index).history]
