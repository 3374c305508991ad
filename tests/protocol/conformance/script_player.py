"""Plays a connection script over a line, step by step, and keeps the time of each."""

from dataclasses import dataclass, field

from file_client import FileClient, FileRefusedError
from pymavlink.dialects.v20 import all as dialect
from pymavlink.mavftp import MAVFTP
from qgc_scripts import Command, Modes, ReadParameters, ReadPlan, Script, Step, Tell
from station_client import StationClient


@dataclass(slots=True)
class Transcript:
    """What a connection came to."""

    step_s: list[tuple[str, float]] = field(default_factory=list)
    parameters: dict[str, float] = field(default_factory=dict)
    modes: list[str] = field(default_factory=list)
    plans: dict[int, int] = field(default_factory=dict)
    results: dict[str, int] = field(default_factory=dict)

    @property
    def total_s(self) -> float:
        """From the first heartbeat to the last reply."""
        return sum(seconds for _, seconds in self.step_s)


def play(script: Script, station: StationClient) -> Transcript:
    """Connect as this version does.

    Raises:
        AssertionError: a request was not answered; names the step.
    """
    done = Transcript()
    assert station.hear(lambda m: m.get_type() == "HEARTBEAT", 3.0) is not None, "no vehicle on this line"
    for step in script.steps:
        began_s = station.line.now_s
        _take(step, station, done)
        done.step_s.append((str(step)[:60], station.line.now_s - began_s))
        assert not station.unanswered, f"{step}: no answer to {dict(station.unanswered)}"
    return done


def _take(step: Step, station: StationClient, done: Transcript) -> None:
    match step:
        case Tell():
            build = getattr(dialect, f"MAVLink_{step.message}_message")
            target = station.vehicle if step.is_targeted else ()
            for row in step.rows:
                station.send(build(*target, *row))
        case Command():
            answer = station.command(step.number, *step.params, brings=step.brings)
            if answer is not None:
                done.results[f"{step.number} {step.params[:1]}"] = answer.result
        case Modes():
            _read_modes(station, done)
        case ReadParameters():
            _read_parameters(step.path, station, done)
        case ReadPlan():
            items = station.download(step.mission_type)
            assert items is not None, f"list {step.mission_type} did not come"
            done.plans[step.mission_type] = len(items)


def _read_modes(station: StationClient, done: Transcript) -> None:
    index, most = 1, 1
    while index <= most:
        answer = station.command(
            dialect.MAV_CMD_REQUEST_MESSAGE,
            float(dialect.MAVLINK_MSG_ID_AVAILABLE_MODES),
            float(index),
            brings=dialect.MAVLINK_MSG_ID_AVAILABLE_MODES,
        )
        if answer is None or answer.message is None:
            return  # refused: the built-in list serves
        assert answer.message.mode_index == index
        most = answer.message.number_modes
        done.modes.append(answer.message.mode_name)
        index += 1


def _read_parameters(path: str, station: StationClient, done: Transcript) -> None:
    files = FileClient(station)
    try:
        packed = files.read(path)
    except FileRefusedError:
        values = station.parameters()
        assert values is not None, "the parameters did not come"
        done.parameters = values
        return
    assert packed is not None, f"{path} did not come"
    decoded = MAVFTP.ftp_param_decode(packed)
    assert decoded is not None, f"{path} is no packed parameter file"
    done.parameters = {name.decode(): value for name, value, _ in decoded.params}
    files.ask(dialect.MAV_FTP_OPCODE_RESETSESSION)
