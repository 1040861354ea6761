/*
 * Walks a step table: a controller that runs a motion without a host, on an ATmega328P at 16 MHz.
 *
 * plan.h is the table of `stepscope tables SCENARIO --format avr --with-walker --name plan --out plan.h`. The command also
 * writes stepscope_walk.h, which walks the table: plan_next() returns the cycles to the next step.
 *
 * Timer1 counts the processor's cycles and is never reset, so nothing is lost between two steps; the compare register
 * moves from step to step. It has 16 bits: longer waits use intermediate matches that do nothing.
 *
 *   compare match    |             |             |     |
 *   STEP           __|~~|__________|~~|________________|~~|____
 *   cycles           |<- interval->|<--0x8000--->|rest>|
 *
 * The interrupt first raises STEP, always the same number of cycles after its start. Its start has jitter: the current
 * instruction is finished first, and main() disables all interrupts while it computes a report.
 */
#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/sleep.h>
#include <util/atomic.h>
#include <util/crc16.h>

#include "plan.h"

/* Port B */
#define STEP _BV(PORTB0)
#define DIR _BV(PORTB1)

/* Bit rate of a report: 16 MHz / (8 * (UBRR0 + 1)) = 500000 baud, with U2X0 */
#define REPORT_UBRR 3

#if PLAN_CLOCK_HZ != F_CPU
#error "plan.h has another clock than Timer1: use a scenario with clock_hz 16000000"
#endif
#if PLAN_FRACTION_BITS > 8
#error "plan.h has times of 64 bits: use --entries ticks or q8"
#endif

static plan_walk walk;
static uint8_t event;

/* Cycles from the next match to the event. */
static uint32_t beyond;

static volatile int16_t position;
static volatile uint8_t done;

/* Loads the next event. A change of direction is a wait of 0 cycles, never two in a row. */
static void next_event(void)
{
    event = plan_next(&walk, &beyond);
    if (event == STEPSCOPE_WAIT && beyond == 0)
        event = plan_next(&walk, &beyond);
    if (event == STEPSCOPE_END) {
        TIMSK1 = 0;
        done = 1;
    }
}

/* Sets the next match: the event, or an intermediate one that leaves at least 0x8000 cycles. */
static void set_match(void)
{
    uint16_t way = beyond > 0xffff ? 0x8000 : beyond;
    OCR1A += way;
    beyond -= way;
}

ISR(TIMER1_COMPA_vect)
{
    if (beyond == 0) {
        if (event == STEPSCOPE_STEP) {
            PORTB |= STEP;
            position += walk.right ? 1 : -1;
        }
        next_event();
        PORTB &= ~STEP;
        /* If the direction changes here, DIR changes after the fall. */
        PORTB = walk.right ? DIR : 0;
    }
    set_match();
}

static void send(uint8_t byte)
{
    loop_until_bit_is_set(UCSR0A, UDRE0);
    UDR0 = byte;
}

/*
 * Sends the position of the motor: low byte, high byte, and a CRC of both. The CRC is computed with interrupts disabled,
 * which is unnecessary and causes the late steps of the recording.
 */
static void report(void)
{
    uint8_t low, high, check;
    ATOMIC_BLOCK(ATOMIC_RESTORESTATE)
    {
        low = position;
        high = position >> 8;
        check = _crc_ibutton_update(_crc_ibutton_update(0, low), high);
    }
    send(low);
    send(high);
    send(check);
}

int main(void)
{
    DDRB = STEP | DIR;
    UBRR0 = REPORT_UBRR;
    UCSR0A = _BV(U2X0);
    UCSR0B = _BV(TXEN0);
    send('S');

    plan_begin(&walk);
    next_event();
    PORTB = walk.right ? DIR : 0;
    TCCR1B = _BV(CS10);
    OCR1A = TCNT1;
    set_match();
    TIFR1 = _BV(OCF1A);
    TIMSK1 = _BV(OCIE1A);
    sei();
    while (!done)
        report();

    /* With interrupts disabled, nothing wakes the chip. */
    cli();
    sleep_enable();
    sleep_cpu();
}
