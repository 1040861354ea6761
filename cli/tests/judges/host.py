"""An independent host: fills a controller of two channels with ticks, and does what a host must not be punished for.

host.py PORT SEED    prints where the motors should stand, and fails where an answer is not the contract's
"""

import random
import sys
import time

from frames import *

port = open_port(sys.argv[1], 1.0)
chance = random.Random(int(sys.argv[2]))


def ask(kind, body=b"", address=0, spoil=None):
    wire = bytearray(emit(address, kind, body))
    if spoil is not None:
        wire[spoil] ^= 0x40
    port.write(bytes(wire))
    run = read_run(port)
    return None if run is None else parse(run)


def ack(kind, body=b""):
    """Asks again after silence, as long as a loaded machine may need."""
    for _ in range(20):
        answer = ask(kind, body)
        if answer is None:
            port.write(b"\0")
            continue
        address, told, rest = answer
        assert (address, told) == (0, kind | 0x80), f"{kind}: {answer}"
        return rest
    raise AssertionError(f"no answer to {kind}")


def told():
    return status(ack(STATUS))


while told()[0] != STATE_READY:
    time.sleep(0.01)
_, free, seq, faults, base = told()
assert (seq, faults, base) == (0, 0, 0), told()
assert struct.unpack("<ii", ack(POSITIONS)[9:]) == (0, 0)

# What is no frame, or another's, is not answered; what is refused has its reason.
assert ask(STATUS, address=9) is None
assert ask(STATUS, spoil=3) is None
assert status(ack(STATUS))[3] & 0x04, "a bad CRC sets its flag"
for kind, body, reason in [
    (0x33, b"", UNKNOWN_KIND),
    (STATUS, b"x", BAD_BODY),
    (TICKS, bytes([0, 2, 1, 1]), BAD_BODY),
    (TICKS, bytes([5, 1, 1, 1]), BAD_SEQ),
    (TICKS, bytes([0, 1, 127, 1]), TOO_MANY_STEPS),
]:
    answer = ask(kind, body)
    assert answer is not None and answer[1] == NAK and answer[2][0] == reason, f"{kind} {answer}"
ack(RESYNC)

position, sent = [0, 0], 0
for _ in range(40):
    count = chance.randint(1, 6)
    ticks = bytes(chance.randint(0, 4) | chance.choice([0, 0x80]) for _ in range(2 * count))
    body = bytes([seq, count]) + ticks
    while told()[1] < count:
        time.sleep(0.002)
    state, free, expected, faults, done = status(ack(TICKS, body))
    assert expected == (seq + 1) % 256
    if chance.random() < 0.3:
        # The reply was lost, so to say: it is acknowledged once more, and not done twice.
        assert status(ack(TICKS, body))[2] == expected
    seq, sent = expected, sent + count
    for index, byte in enumerate(ticks):
        position[index % 2] += (byte & 0x7F) * (1 if byte & 0x80 else -1)
while told()[0] != STATE_READY:
    time.sleep(0.005)
assert told()[4] == sent, f"{sent} ticks were sent: {told()}"
assert struct.unpack("<ii", ack(POSITIONS)[9:]) == tuple(position), position
state, *_ = status(ack(STOP))
assert state == STATE_STOPPED
answer = ask(TICKS, bytes([seq, 1, 1, 1]))
assert answer[1] == NAK and answer[2][0] == STOPPED
ack(ENABLE)
assert told()[0] == STATE_READY
print(*position, sent)
