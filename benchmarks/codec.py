"""What does a MAVLink message cost on its way in and out, against pymavlink's own parser and packer?"""

from benchmarks.measure import Row, paired
from companion.mavlink.address import Address
from companion.mavlink.codec import Decoder, Encoder
from companion.mavlink.dialect import Message, dialect
from companion.mavlink.signing import Signatory, SigningGuard, Stamps
from companion.mavlink.signing_key import SigningKey

_COUNT = 2000
_MICRO = 1e6 / _COUNT
_KEY = SigningKey.from_passphrase("benchmark")


def _messages() -> list[Message]:
    """The most frequent message of a boat."""
    kinds: list[Message] = [
        dialect.MAVLink_attitude_message(1, 0.0, 0.0, 1.5, 0.0, 0.0, 0.1),
        dialect.MAVLink_global_position_int_message(1, 500000000, -12000000, 0, 0, 100, 20, 0, 9000),
        dialect.MAVLink_vfr_hud_message(2.0, 2.0, 90, 40, 0.0, 0.0),
        dialect.MAVLink_heartbeat_message(11, 3, 1, 10, 4, 3),
    ]
    return [kinds[number % len(kinds)] for number in range(_COUNT)]


def rows() -> list[Row]:
    """Encode and decode, without signatures and with them, CPU time a message."""
    return _plain_rows() + _signed_rows()


def _guard() -> SigningGuard:
    return SigningGuard(Signatory(_KEY, Stamps()), "required", 0)


def _signing_peer() -> dialect.MAVLink:
    peer = dialect.MAVLink(None, 1, 1)
    peer.robust_parsing = True
    peer.signing.secret_key, peer.signing.sign_outgoing, peer.signing.timestamp = _KEY.reveal(), True, 1
    return peer


def _signed_rows() -> list[Row]:
    messages = _messages()
    encoder, sealer = Encoder(Address(1, 1)), _guard()
    sealed = [sealer.seal(encoder.encode(message)) for message in messages]
    stream = b"".join(frame for frame in sealed if frame is not None)

    def encode_and_seal() -> None:
        guard = _guard()
        for message in messages:
            guard.seal(encoder.encode(message))

    def pack_signed() -> None:
        packer = _signing_peer()
        for message in messages:
            message.pack(packer)

    def decode_and_verify() -> None:
        guard = _guard()
        assert (
            sum(guard.admits(received.frame) for received in Decoder(datagram=False).feed(stream)) == _COUNT
        )

    def parse_signed() -> None:
        parser = _signing_peer()
        assert len(parser.parse_buffer(stream)) == parser.signing.goodsig_count == _COUNT

    return [
        paired("encode and sign a message", "µs", _MICRO, encode_and_seal, "pymavlink", pack_signed),
        paired("decode and verify a message", "µs", _MICRO, decode_and_verify, "pymavlink", parse_signed),
    ]


def _plain_rows() -> list[Row]:
    messages = _messages()
    encoder = Encoder(Address(1, 1))
    stream = b"".join(map(encoder.encode, messages))

    def encode() -> None:
        for message in messages:
            encoder.encode(message)

    def pack() -> None:
        packer = dialect.MAVLink(None, 1, 1)
        for message in messages:
            message.pack(packer)

    def decode() -> None:
        assert len(Decoder(datagram=False).feed(stream)) == _COUNT

    def parse() -> None:
        parser = dialect.MAVLink(None)
        parser.robust_parsing = True
        assert len(parser.parse_buffer(stream)) == _COUNT

    return [
        paired("CPU time to encode a message", "µs", _MICRO, encode, "pymavlink", pack),
        paired("decode a message from a stream", "µs", _MICRO, decode, "pymavlink", parse),
    ]
