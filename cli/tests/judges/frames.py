"""DESIGN A6 written down once more, on other people's COBS and CRC-32C: nothing here comes from Stepscope."""

import struct

import google_crc32c
from cobs import cobs

TICKS, ENABLE, DISABLE, STATUS, STOP, RESYNC, POSITIONS = range(1, 8)
NAK = 0xFF
BAD_SEQ, QUEUE_FULL, TOO_MANY_STEPS, BUSY, STOPPED, BAD_BODY, UNKNOWN_KIND = range(1, 8)
STATE_BUSY, STATE_READY, STATE_MOVING, STATE_STOPPED = range(4)


def emit(address, kind, body=b""):
    content = bytes([address, kind]) + body
    return cobs.encode(content + struct.pack("<I", google_crc32c.value(content))) + b"\0"


def parse(wire):
    """Address, kind and body of a run of bytes without its zero; None if it is no frame."""
    try:
        decoded = cobs.decode(wire)
    except cobs.DecodeError:
        return None
    content, check = decoded[:-4], decoded[-4:]
    if len(decoded) < 6 or struct.unpack("<I", check)[0] != google_crc32c.value(content):
        return None
    return content[0], content[1], content[2:]


def status(body):
    """State, free places, expected sequence number, faults, ticks done."""
    return struct.unpack("<BBBHI", body)


def open_port(name, timeout):
    """A port by path, or tcp:ADDRESS."""
    import serial

    url = "socket://" + name[4:] if name.startswith("tcp:") else name.removeprefix("pty:")
    return serial.serial_for_url(url, baudrate=115200, timeout=timeout)


def read_run(port):
    """The bytes up to the next zero, without it; None if none came in time."""
    run = port.read_until(b"\0")
    return run[:-1] if run.endswith(b"\0") else None
