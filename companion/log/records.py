"""ArduPilot's self-describing log format, and the records of the onboard log.

A record is A3 95, its type number, then its fields, little-endian and packed. FMT records define the types,
FMTU gives units and multipliers by letters, and UNIT and MULT define the letters (ArduPilot developer
documentation, "Understanding and modifying log messages"). Records have ArduPilot Rover's names where the
meaning is the same; docs/logs.md describes their fields.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial
from struct import Struct
from typing import Final

MAGIC: Final = (0xA3, 0x95)

_CODES: Final = {
    "b": "b", "B": "B", "h": "h", "H": "H", "i": "i", "I": "I", "q": "q", "Q": "Q", "f": "f", "d": "d",
    "n": "4s", "N": "16s", "Z": "64s",
    "c": "h", "C": "H", "e": "i", "E": "I",  # hundredths
    "L": "i",  # degrees × 1e7
    "M": "B",  # mode
}  # fmt: skip

UNITS: Final = {
    "-": "", "A": "A", "a": "Ah", "b": "B", "d": "deg", "D": "deglatitude", "G": "Gauss", "h": "degheading",
    "k": "deg/s", "m": "m", "n": "m/s", "o": "m/s/s", "O": "degC", "s": "s", "q": "rpm", "S": "satellites",
    "U": "deglongitude", "v": "V", "w": "Ohm", "X": "W.h", "Y": "us", "z": "Hz", "%": "%", "#": "instance",
}  # fmt: skip
MULTIPLIERS: Final = {
    "-": 0.0, "?": 1.0, "0": 1.0, "A": 1e-1, "B": 1e-2, "C": 1e-3, "F": 1e-6, "G": 1e-7
}  # fmt: skip


@dataclass(slots=True, eq=False)
class RecordKind:
    """One type of record.

    codes: one letter per field, as in _CODES. units, multipliers: one letter per field, as in UNITS and
    MULTIPLIERS. `pack` takes the raw values in order and returns the record.
    Raises ValueError: inconsistent, or too long for the FMT record; names the type. `pack` raises
    struct.error for a value that does not fit its field.
    """

    number: int
    name: str
    codes: str
    columns: str
    units: str
    multipliers: str
    size_bytes: int = field(init=False)
    pack: Callable[..., bytes] = field(init=False)

    def __post_init__(self) -> None:
        name, count = self.name, len(self.columns.split(","))
        if not (len(self.codes) == count == len(self.units) == len(self.multipliers)):
            raise ValueError(f"log record {name}: codes, columns, units and multipliers differ in number")
        if len(name) > 4 or count > 16 or len(self.columns) > 64 or not 0 < self.number < 256:
            raise ValueError(f"log record {name}: too long for a FMT record")
        if set(self.units) - set(UNITS) or set(self.multipliers) - set(MULTIPLIERS):
            raise ValueError(f"log record {name}: a unit or multiplier that has no letter")
        layout = Struct("<3B" + "".join(_CODES[code] for code in self.codes))
        self.size_bytes = layout.size
        self.pack = partial(layout.pack, *MAGIC, self.number)


FMT: Final = RecordKind(128, "FMT", "BBnNZ", "Type,Length,Name,Format,Columns", "-b---", "-----")
UNIT: Final = RecordKind(129, "UNIT", "QbZ", "TimeUS,Id,Label", "s--", "F--")
MULT: Final = RecordKind(130, "MULT", "Qbd", "TimeUS,Id,Mult", "s--", "F--")
FMTU: Final = RecordKind(131, "FMTU", "QBNN", "TimeUS,FmtType,UnitIds,MultIds", "s---", "F---")


def file_header(kinds: Sequence[RecordKind]) -> bytes:
    """The start of a log file: the definitions of all record types."""
    every = (FMT, UNIT, MULT, FMTU, *kinds)
    parts = [
        FMT.pack(k.number, k.size_bytes, k.name.encode(), k.codes.encode(), k.columns.encode()) for k in every
    ]
    parts += [UNIT.pack(0, ord(letter), label.encode()) for letter, label in UNITS.items()]
    parts += [MULT.pack(0, ord(letter), factor) for letter, factor in MULTIPLIERS.items()]
    parts += [FMTU.pack(0, k.number, k.units.encode(), k.multipliers.encode()) for k in every]
    return b"".join(parts)


_PID = ("QfffffffffB", "TimeUS,Tar,Act,Err,P,I,D,FF,Dmod,SRate,Limit")
_COMMAND = ("QHHHffffLLfB", "TimeUS,CTot,CNum,CId,Prm1,Prm2,Prm3,Prm4,Lat,Lng,Alt,Frame")
_OUTPUTS = "TimeUS," + ",".join(f"C{number}" for number in range(1, 15))

# State
ATT: Final = RecordKind(
    1, "ATT", "QffffffB", "TimeUS,DesRoll,Roll,DesPitch,Pitch,DesYaw,Yaw,AEKF", "sddddhh-", "F000000-"
)
POS: Final = RecordKind(2, "POS", "QLLfff", "TimeUS,Lat,Lng,Alt,RelHomeAlt,RelOriginAlt", "sDUmmm", "FGG000")
XKF1: Final = RecordKind(
    3, "XKF1", "QBccCfffffffccce", "TimeUS,C,Roll,Pitch,Yaw,VN,VE,VD,dPD,PN,PE,PD,GX,GY,GZ,OH",
    "s#ddhnnnnmmmkkkm", "F-BBB0000000BBBB",
)  # fmt: skip
BOAT: Final = RecordKind(4, "BOAT", "Qfffff", "TimeUS,Surge,Sway,YawRate,PosAge,HdgAge", "snnkss", "F00000")
EST: Final = RecordKind(11, "EST", "QfffH", "TimeUS,CurN,CurE,PosSD,Flt", "snnm-", "F000-")
XKF3: Final = RecordKind(
    13, "XKF3", "QBcccccchhhccff", "TimeUS,C,IVN,IVE,IVD,IPN,IPE,IPD,IMX,IMY,IMZ,IYAW,IVT,RErr,ErSc",
    "s#nnnmmmGGGd---", "F-BBBBBBCCCB-00",
)  # fmt: skip
XKF4: Final = RecordKind(
    14, "XKF4", "QBcccccfffHBIHb", "TimeUS,C,SV,SP,SH,SM,SVT,errRP,OFN,OFE,FS,TS,SS,GPS,PI",
    "s#------mm-----", "F-BBBBB000-----",
)  # fmt: skip
ESD: Final = RecordKind(
    15, "ESD", "Qfffffffffff", "TimeUS,N,E,Hd,Su,CN,CE,GB,CO,G,RN,RE", "smmdnnnkd-mm", "F00000000000"
)
EBIA: Final = RecordKind(16, "EBIA", "Qffffff", "TimeUS,GB,CO,G,RN,RE,Dly", "skd-mms", "F000000")
EHYP: Final = RecordKind(17, "EHYP", "Qfff", "TimeUS,Cmp,Gyr,Gns", "s---", "F000")
AVD: Final = RecordKind(12, "AVD", "QBffBf", "TimeUS,Stg,Lim,dR0,Mov,Cls", "s-nm-n", "F-00-0")
PIDS: Final = RecordKind(5, "PIDS", *_PID, "sddd-------", "F000-------")
PIDA: Final = RecordKind(6, "PIDA", *_PID, "snnn-------", "F000-------")
NTUN: Final = RecordKind(
    7, "NTUN", "QfffHf", "TimeUS,WpDist,WpBrg,DesYaw,Yaw,XTrack", "smhhdm", "F000B0"
)  # fmt: skip
STER: Final = RecordKind(
    8, "STER", "Qhfffff", "TimeUS,SteerIn,SteerOut,DesLatAcc,LatAcc,DesTurnRate,TurnRate", "s--ookk",
    "F--0000",
)  # fmt: skip
THR: Final = RecordKind(
    9, "THR", "Qhffff", "TimeUS,ThrIn,ThrOut,DesSpeed,Speed,AccX", "s--nno", "F--000"
)  # fmt: skip
RCOU: Final = RecordKind(10, "RCOU", "Q" + 14 * "H", _OUTPUTS, "s" + 14 * "Y", "F" + 14 * "-")

# Sensors
GPS: Final = RecordKind(
    20, "GPS", "QBBIHBcLLeffffB", "TimeUS,I,Status,GMS,GWk,NSats,HDop,Lat,Lng,Alt,Spd,GCrs,VZ,Yaw,U",
    "s#-s-S-DUmnhnh-", "F--C-0BGGB0000-",
)  # fmt: skip
GPA: Final = RecordKind(
    21, "GPA", "QBCCCCfBIHfB", "TimeUS,I,VDop,HAcc,VAcc,SAcc,YAcc,VV,SMS,Delta,Und,cn0", "s#-mmnd-ss--",
    "F-BBBB0-CC--",
)  # fmt: skip
RFND: Final = RecordKind(22, "RFND", "QBCBB", "TimeUS,Instance,Dist,Stat,Orient", "s#m--", "F-B--")
SONR: Final = RecordKind(23, "SONR", "Qfff", "TimeUS,Brg,Dist,Max", "sdmm", "F000")
BAT: Final = RecordKind(
    24, "BAT", "QBfffffcfBBB", "TimeUS,Inst,Volt,VoltR,Curr,CurrTot,EnrgTot,Temp,Res,RemPct,H,SH",
    "s#vvAaXOw%-%", "F-000C0B00-0",
)  # fmt: skip
ESC: Final = RecordKind(
    46, "ESC", "QBffffcfcf", "TimeUS,Instance,RPM,RawRPM,Volt,Curr,Temp,CTot,MotTemp,Err", "s#qqvAOaO%",
    "F-00--BCB-",
)  # fmt: skip

DPTH: Final = RecordKind(
    27, "DPTH", "QBLLffbf", "TimeUS,Inst,Lat,Lng,Depth,Temp,Quality,PosZ", "s#DUmO%m", "F-GG00-0"
)  # fmt: skip
PROB: Final = RecordKind(28, "PROB", "QNfLLN", "TimeUS,Name,Value,Lat,Lng,Unit", "s--DU-", "F--GG-")
MAG: Final = RecordKind(
    29, "MAG", "QBhhhhhhhhhBI", "TimeUS,I,MagX,MagY,MagZ,OfsX,OfsY,OfsZ,MOX,MOY,MOZ,Health,S",
    "s#GGGGGGGGG-s", "F-CCCCCCCCC-F",
)  # fmt: skip
HDG: Final = RecordKind(45, "HDG", "Qff", "TimeUS,Hdg,GyrZ", "shk", "F00")
RCIN: Final = RecordKind(25, "RCIN", "Q" + 14 * "H", _OUTPUTS, "s" + 14 * "Y", "F" + 14 * "-")
RSSI: Final = RecordKind(26, "RSSI", "Qff", "TimeUS,RXRSSI,RXLQ", "s-%", "F--")

# Events
MODE: Final = RecordKind(30, "MODE", "QMBB", "TimeUS,Mode,ModeNum,Rsn", "s---", "F---")
MSG: Final = RecordKind(31, "MSG", "QZ", "TimeUS,Message", "s-", "F-")
EV: Final = RecordKind(32, "EV", "QB", "TimeUS,Id", "s-", "F-")
ERR: Final = RecordKind(33, "ERR", "QBB", "TimeUS,Subsys,ECode", "s--", "F--")
ARM: Final = RecordKind(
    34, "ARM", "QBIBB", "TimeUS,ArmState,ArmChecks,Forced,Method", "s----", "F----"
)  # fmt: skip
ORGN: Final = RecordKind(35, "ORGN", "QBLLe", "TimeUS,Type,Lat,Lng,Alt", "s-DUm", "F-GGB")
CMD: Final = RecordKind(36, "CMD", *_COMMAND, "s-------DUm-", "F-------GG0-")
MISE: Final = RecordKind(37, "MISE", *_COMMAND, "s-------DUm-", "F-------GG0-")
PARM: Final = RecordKind(38, "PARM", "QNff", "TimeUS,Name,Value,Default", "s---", "F---")
VER: Final = RecordKind(
    39, "VER", "QBHBBBBIZHB", "TimeUS,BT,BST,Maj,Min,Pat,FWT,GH,FWS,APJ,BU", "s----------", "F----------"
)  # fmt: skip
PAYL: Final = RecordKind(43, "PAYL", "QNfLL", "TimeUS,Name,Val,Lat,Lng", "s--DU", "F--GG")
CAM: Final = RecordKind(
    44, "CAM", "QBHIHLLeeeccC", "TimeUS,I,Img,GPSTime,GPSWeek,Lat,Lng,Alt,RelAlt,GPSAlt,R,P,Y",
    "s#---DUmmmddd", "F----GGBBBBBB",
)  # fmt: skip

# Computer
PM: Final = RecordKind(
    40, "PM", "QHHHIIHHIIIIII", "TimeUS,LR,NLon,NL,MaxT,Mem,Load,ErrL,IntE,ErrC,SPIC,I2CC,I2CI,Ex",
    "sz--sb%------s", "F---F0A------F",
)  # fmt: skip
MAV: Final = RecordKind(
    41, "MAV", "QBHHHBHH", "TimeUS,chan,txp,rxp,rxdp,flags,ss,tf", "s#----s-", "F-000-C-"
)  # fmt: skip
DSF: Final = RecordKind(42, "DSF", "QIHIIII", "TimeUS,Dp,Blk,Bytes,FMn,FMx,FAv", "s--bbbb", "F--0000")

KINDS: Final = (
    ATT, POS, XKF1, XKF3, XKF4, BOAT, EST, ESD, EBIA, EHYP, AVD, PIDS, PIDA, NTUN, STER, THR, RCOU, GPS, GPA,
    RFND, SONR, DPTH, PROB, MAG, HDG, BAT, ESC, RCIN, RSSI, MODE, MSG, EV, ERR, ARM, ORGN, CMD, MISE, PARM,
    VER, PAYL, CAM, PM, MAV, DSF,
)  # fmt: skip
HEADER: Final = file_header(KINDS)
