"""gpsd as its manual says (gpsd_json(5)): a greeting, silence until ?WATCH, then reports to each client."""

import json
import socket

DEVICE = "/dev/ttyACM0"
GREETING: dict[str, object] = {
    "class": "VERSION",
    "release": "3.25",
    "rev": "3.25",
    "proto_major": 3,
    "proto_minor": 15,
}
DEVICES: dict[str, object] = {
    "class": "DEVICES",
    "devices": [{"class": "DEVICE", "path": DEVICE, "driver": "u-blox"}],
}


def tpv(second: float, **fields: object) -> dict[str, object]:
    """A TPV of gpsd 3.25 with a u-blox receiver; None leaves a field out."""
    report: dict[str, object] = {
        "class": "TPV", "device": DEVICE, "mode": 3, "time": f"2024-05-28T09:27:{second:06.3f}Z",
        "leapseconds": 18, "lat": 50.5, "lon": -1.2, "altHAE": 59.5, "altMSL": 12.5, "alt": 12.5,
        "epx": 1.1, "epy": 1.2, "epv": 3.0, "track": 90.0, "magtrack": 91.3, "speed": 1.5, "climb": 0.0,
        "eps": 2.1, "eph": 1.6, "velN": 0.0, "velE": 1.5, "velD": 0.0,
    }  # fmt: skip
    return {key: value for key, value in (report | fields).items() if value is not None}


def sky(used: int = 9, **fields: object) -> dict[str, object]:
    """A SKY report."""
    satellites = [
        {"PRN": 1 + n, "el": 40.0, "az": 30.0 * n, "ss": 41.0, "used": n < used, "gnssid": 0}
        for n in range(12)
    ]
    return {
        "class": "SKY",
        "device": "/dev/ttyACM0",
        "hdop": 0.85,
        "pdop": 1.6,
        "satellites": satellites,
    } | fields


def line(report: dict[str, object]) -> bytes:
    """As it goes over the socket."""
    return json.dumps(report, separators=(",", ":")).encode() + b"\r\n"


class GpsdServer:
    """A server on loopback. Clients that have sent ?WATCH with enable and json get the reports."""

    def __init__(self, port: int = 0) -> None:
        self._listener = socket.create_server(("127.0.0.1", port), reuse_port=False)
        self._listener.setblocking(False)
        self.port = int(self._listener.getsockname()[1])
        self.clients: list[socket.socket] = []
        self._watching: set[socket.socket] = set()

    def serve(self) -> None:
        """Greet new clients and read their requests."""
        try:
            while True:
                client, _ = self._listener.accept()
                client.setblocking(False)
                client.sendall(line(GREETING))
                self.clients.append(client)
        except BlockingIOError:
            pass
        for client in self.clients:
            try:
                asked = client.recv(4096).decode()
            except BlockingIOError:
                continue
            command, _, argument = asked.strip().rstrip(";").partition("=")
            if command == "?DEVICES":
                client.sendall(line(DEVICES))
            if command == "?WATCH" and json.loads(argument) == {"enable": True, "json": True}:
                self._watching.add(client)
                client.sendall(line(DEVICES) + line({"class": "WATCH", "enable": True, "json": True}))

    @property
    def is_watched(self) -> bool:
        """Whether a client gets reports."""
        return bool(self._watching)

    def send(self, data: bytes) -> None:
        """To each client that watches."""
        for client in self._watching:
            client.sendall(data)

    def close(self) -> None:
        """gpsd ends."""
        for client in self.clients:
            client.close()
        self._listener.close()
