"""Configuration of the battery monitor."""

from typing import Annotated, Literal

from msgspec import Meta

from companion.config.board import I2cBus
from companion.config.section import Positive, Section


class BatteryPart(Section, frozen=True):
    """Battery monitor on I²C: across a shunt (INA219, INA226, INA228), or by divider and Hall sensor on the
    inputs of an ADS1115.
    """

    driver: Literal["ina219", "ina226", "ina228", "ads1115", "none"] = "none"
    i2c_bus: I2cBus = 1  # of parts.i2c_bus unless given
    address: Annotated[int, Meta(ge=0, le=0x77)] = 0  # 0: 0x40, of the ADS1115 0x48
    timeout_s: Positive = 3.0  # without a reading it is silent: 30 at its 10 Hz; ArduPilot waits 5 s
    # The board's shunt. Beyond 0.32 V over it (INA219), 0.082 V (INA226) or 0.164 V (INA228) the current is
    # unknown.
    shunt_ohm: Positive = 0.1
    voltage_channel: Annotated[int, Meta(ge=0, le=3)] = 0
    divider: Positive = 11.0  # pack volts per volt at the input: 100 kΩ above 10 kΩ
    current_channel: Annotated[int, Meta(ge=-1, le=3)] = 1  # −1: no Hall sensor
    volt_per_a: float = 0.0264  # ACS758LCB-050B at 3.3 V: 40 mV/A at 5 V, and in proportion to its supply
    zero_v: float = 1.65  # its output without a current: half the supply

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.volt_per_a == 0.0:
            raise ValueError("volt_per_a = 0: expected the sensor's volts per ampere, negative if reversed")
