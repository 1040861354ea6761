"""An independent controller of two channels, 2 ms a tick, on a socket: what it was told, and a few replies that go lost.

device.py SEED    prints its port; with the end of the connection ticks and positions
"""

import random
import socket
import sys
import time

from frames import *

chance = random.Random(int(sys.argv[1]))
DEPTH, TICK_S = 200, 0.002
listener = socket.create_server(("127.0.0.1", 0))
print(listener.getsockname()[1], flush=True)
stream, _ = listener.accept()
stream.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
stream.settimeout(TICK_S / 4)

queue, running, ends = [], None, 0.0
seq, taken, done, stopped, positions = 0, False, 1_000_000, False, [50, -7]
replies = 0


def go_on(now):
    """Runs ticks up to a time: a tick's steps count at its end."""
    global running, ends, done
    while running is not None and ends <= now:
        for channel, byte in enumerate(running):
            positions[channel] += (byte & 0x7F) * (1 if byte & 0x80 else -1)
        done += 1
        running = queue.pop(0) if queue else None
        ends += TICK_S
    if running is None and queue:
        running, ends = queue.pop(0), now + TICK_S


def told():
    moving = running is not None or queue
    state = STATE_STOPPED if stopped else STATE_MOVING if moving else STATE_READY
    return struct.pack("<BBBHI", state, DEPTH - len(queue), seq, 0, done)


def answer(kind, body):
    global seq, taken, stopped, running
    if kind == TICKS:
        count = body[1] if len(body) > 1 else 0
        if len(body) != 2 + 2 * count or not 1 <= count <= 32:
            return NAK, bytes([BAD_BODY])
        if taken and body[0] == (seq - 1) % 256:
            return kind | 0x80, b""
        if body[0] != seq:
            return NAK, bytes([BAD_SEQ])
        if stopped:
            return NAK, bytes([STOPPED])
        if count > DEPTH - len(queue):
            return NAK, bytes([QUEUE_FULL])
        queue.extend(body[2 + 2 * k : 4 + 2 * k] for k in range(count))
        seq, taken = (seq + 1) % 256, True
        return kind | 0x80, b""
    if kind not in (STATUS, STOP, POSITIONS):
        return NAK, bytes([UNKNOWN_KIND])
    if body:
        return NAK, bytes([BAD_BODY])
    if kind == STOP:
        stopped, running = True, None
        queue.clear()
    return kind | 0x80, b""


run = b""
while True:
    try:
        heard = stream.recv(4096)
    except TimeoutError:
        go_on(time.monotonic())
        continue
    except ConnectionError:
        break
    if not heard:
        break
    now = time.monotonic()
    go_on(now)
    *runs, run = (run + heard).split(b"\0")
    for whole in runs:
        frame = parse(whole) if whole else None
        if frame is None or frame[0] != 3:
            continue
        kind, reason = answer(frame[1], frame[2])
        go_on(now)
        counters = struct.pack("<ii", *positions) if kind == POSITIONS | 0x80 else b""
        replies += 1
        # One in six goes lost, one in six comes in two parts.
        lost = chance.randrange(6)
        wire = emit(3, kind, reason + told() + counters)
        if lost == 1:
            stream.sendall(wire[:5])
            time.sleep(0.003)
            stream.sendall(wire[5:])
        elif lost:
            stream.sendall(wire)
go_on(time.monotonic() + 1)
print(done - 1_000_000, *positions)
