/*
 * A controller that executes the ticks of a framed line (docs/how-it-works.md, DESIGN A6 and A7), on an ATmega328P at
 * 16 MHz, for `stepscope send`. It has two channels; tick-controller.json is the scenario with the same parameters.
 *
 *   framed_line.c ── valid frame ──> queue of ticks ── Timer1, one match per slot ──> DIR and STEP
 *                    (main loop)                       (interrupt)
 *
 * Each slot begins with a match, every SLOT_CYCLES. Other interrupts and the main loop may delay the interrupt, so it writes
 * the pins when the timer has reached a fixed count after the match. This hides the delays:
 *
 *   match        |                         |
 *   interrupt    ---|======|----------------|======|------
 *   STEP         ________|~|_________________|~~|_________     EDGE_CYCLES after the match, PULSE_CYCLES long
 *
 * It is full duplex, so it drives no transceiver. It has no self-test, and accepts at most TICKS_MAX ticks per frame, which is
 * enough for every valid TICKS.
 */
#include <avr/interrupt.h>
#include <avr/io.h>
#include <stdbool.h>
#include <string.h>
#include <util/atomic.h>

#include "framed_line.h"

#define ADDRESS 0
#define ALL 255
#define CHANNELS 2
#define SLOTS 20
#define SLOT_CYCLES 1600
#define QUEUE 200
#define TICKS_MAX 32

#if 2 + TICKS_MAX * CHANNELS > BODY_KEPT
#error "a frame of ticks exceeds the buffer: increase BODY_KEPT in framed_line.h"
#endif

/* From a slot's match to the rise of STEP: longer than all possible delays. */
#define EDGE_CYCLES 400
#define PULSE_CYCLES 160

/* Port B: STEP of both channels, DIR of both, EN */
#define STEP(channel) _BV(PORTB0 + (channel))
#define DIR(channel) _BV(PORTB2 + (channel))
#define STEPS (STEP(0) | STEP(1))
#define DIRS (DIR(0) | DIR(1))
#define EN _BV(PORTB4)

enum kind { TICKS = 1, ENABLE, DISABLE, STATUS, STOP, RESYNC, POSITIONS };
enum answer { ACK = 0, BAD_SEQ, QUEUE_FULL, TOO_MANY_STEPS, BUSY, STOPPED, BAD_BODY, UNKNOWN_KIND };
enum state { STATE_READY = 1, STATE_MOVING, STATE_STOPPED };
/* In addition to those of the line */
enum fault {
    QUEUE_OVERFLOW = 1 << 4,
    FAULT_TOO_MANY_STEPS = 1 << 5,
    FAULT_BAD_SEQ = 1 << 6,
    UNDERRUN = 1 << 7,
};

/* Shared with the interrupts */
static volatile uint16_t faults;
static volatile uint32_t ticks_done;
static volatile int32_t positions[CHANNELS];
static uint8_t queue[QUEUE][CHANNELS];
static volatile uint8_t queued;
static volatile bool is_moving;

static bool is_stopped;
static uint8_t expected_seq;
static bool has_accepted;

void fault(uint16_t flag)
{
    ATOMIC_BLOCK(ATOMIC_RESTORESTATE) { faults |= flag; }
}

/* ---- ticks: Timer1 counts the cycles of a slot ---- */

static uint8_t head, tail, slot, steps[CHANNELS], phase[CHANNELS];

/* The place in the queue after this one. */
static uint8_t after(uint8_t place)
{
    return place + 1 == QUEUE ? 0 : place + 1;
}

/* Starts the tick at the head of the queue: its DIR lines change now, its first steps EDGE_CYCLES after the match. */
static void begin_tick(void)
{
    uint8_t dirs = 0;
    for (uint8_t i = 0; i < CHANNELS; i++) {
        uint8_t order = queue[head][i];
        if (order & 0x80)
            dirs |= DIR(i);
        steps[i] = order & 0x7f;
        phase[i] = SLOTS / 2;
    }
    PORTB = (PORTB & ~DIRS) | dirs;
    head = after(head);
    queued--;
    slot = 0;
}

/* After the last slot of a tick: returns whether another tick follows. */
static bool next_tick(void)
{
    ticks_done++;
    if (queued == 0) {
        if (steps[0] | steps[1])
            faults |= UNDERRUN;
        is_moving = false;
        TIMSK1 = 0;
        return false;
    }
    begin_tick();
    return true;
}

ISR(TIMER1_COMPA_vect)
{
    if (slot == SLOTS && !next_tick())
        return;
    slot++;
    /* Spread over the tick: a channel steps where its fraction of steps passes an integer. */
    uint8_t rises = 0;
    for (uint8_t i = 0; i < CHANNELS; i++) {
        phase[i] += steps[i];
        if (phase[i] >= SLOTS) {
            phase[i] -= SLOTS;
            rises |= STEP(i);
        }
    }
    while (TCNT1 < EDGE_CYCLES)
        ;
    PORTB |= rises;
    for (uint8_t i = 0; i < CHANNELS; i++)
        if (rises & STEP(i))
            positions[i] += PORTB & DIR(i) ? 1 : -1;
    while (TCNT1 < EDGE_CYCLES + PULSE_CYCLES)
        ;
    PORTB &= ~STEPS;
}

/* Starts the first tick after an idle time; its first match is immediate. */
static void start(void)
{
    ATOMIC_BLOCK(ATOMIC_RESTORESTATE)
    {
        if (!is_moving && queued > 0) {
            is_moving = true;
            begin_tick();
            TCNT1 = SLOT_CYCLES - 100;
            TIFR1 = _BV(OCF1A);
            TIMSK1 = _BV(OCIE1A);
        }
    }
}

/* Emergency stop: immediately no current and no step. */
static void stop(void)
{
    ATOMIC_BLOCK(ATOMIC_RESTORESTATE)
    {
        PORTB &= ~(EN | STEPS);
        TIMSK1 = 0;
        is_moving = false;
        head = tail = queued = 0;
    }
    is_stopped = true;
}

/* ---- replies ---- */

static void reply(uint8_t kind, enum answer answer)
{
    uint8_t frame[2 + 1 + 9 + 4 * CHANNELS + 4], *at = frame;
    *at++ = ADDRESS;
    *at++ = answer == ACK ? kind | 0x80 : 0xff;
    if (answer != ACK)
        *at++ = answer;
    ATOMIC_BLOCK(ATOMIC_RESTORESTATE)
    {
        *at++ = is_stopped ? STATE_STOPPED : is_moving || queued ? STATE_MOVING : STATE_READY;
        *at++ = QUEUE - queued;
        *at++ = expected_seq;
        memcpy(at, (const void *)&faults, 2);
        memcpy(at + 2, (const void *)&ticks_done, 4);
        at += 6;
        if (kind == POSITIONS && answer == ACK) {
            memcpy(at, (const void *)positions, sizeof positions);
            at += sizeof positions;
        }
    }
    line_send(frame, at - frame);
}

/* ---- execution of frames ---- */

/* Queues all ticks or none; the checks are in order of precedence. */
static enum answer take_ticks(const uint8_t *body, uint16_t length)
{
    uint8_t seq = body[0], count = body[1];
    if (length < 2 || count == 0 || count > TICKS_MAX || length != 2 + (uint16_t)count * CHANNELS)
        return BAD_BODY;
    if (has_accepted && seq == (uint8_t)(expected_seq - 1))
        return ACK; /* The host did not receive the reply. */
    if (seq != expected_seq) {
        fault(FAULT_BAD_SEQ);
        return BAD_SEQ;
    }
    if (is_stopped)
        return STOPPED;
    const uint8_t *orders = body + 2;
    for (uint8_t i = 0; i < count * CHANNELS; i++)
        if ((orders[i] & 0x7f) > SLOTS) {
            fault(FAULT_TOO_MANY_STEPS);
            return TOO_MANY_STEPS;
        }
    /* The interrupt only frees places. */
    if (QUEUE - queued < count) {
        fault(QUEUE_OVERFLOW);
        return QUEUE_FULL;
    }
    for (uint8_t i = 0; i < count; i++, orders += CHANNELS) {
        memcpy(queue[tail], orders, CHANNELS);
        tail = after(tail);
    }
    ATOMIC_BLOCK(ATOMIC_RESTORESTATE) { queued += count; }
    expected_seq++;
    has_accepted = true;
    start();
    return ACK;
}

static enum answer do_kind(uint8_t kind, const uint8_t *body, uint16_t length)
{
    if (kind < TICKS || kind > POSITIONS)
        return UNKNOWN_KIND;
    if (kind != TICKS && length > 0)
        return BAD_BODY;
    switch (kind) {
    case TICKS:
        return take_ticks(body, length);
    case ENABLE:
        PORTB |= EN;
        is_stopped = false;
        break;
    case DISABLE:
        if (is_moving || queued)
            return BUSY;
        PORTB &= ~EN;
        is_stopped = true;
        break;
    case STOP:
        stop();
        break;
    case RESYNC:
        expected_seq = 0;
        has_accepted = false;
        ATOMIC_BLOCK(ATOMIC_RESTORESTATE) { faults = 0; }
        break;
    }
    return ACK;
}

void frame_arrived(const uint8_t *frame, uint16_t length)
{
    if (frame[0] != ADDRESS && frame[0] != ALL)
        return;
    enum answer answer = do_kind(frame[1], frame + 2, length - 2);
    if (frame[0] == ADDRESS)
        reply(frame[1], answer);
}

int main(void)
{
    PORTB = EN;
    DDRB = STEPS | DIRS | EN;
    /* Timer1 counts cycles and restarts at each match. */
    OCR1A = SLOT_CYCLES - 1;
    TCCR1B = _BV(WGM12) | _BV(CS10);
    line_begin();
    sei();
    for (;;)
        line_hear();
}
