/*
 * Sends raw packets at a fixed rate: the host of a line, on an ATmega328P at 16 MHz.
 *
 * packets.h contains the packets of the scenario's host: PACKETS packets of PACKET_BYTES bytes, one packet every
 * TICK_CYCLES, each bit BIT_CYCLES long, 8N1.
 *
 * Timer1 counts the processor's cycles and is never reset. The program polls the compare match of each bit in a loop and
 * sets the pin. An edge is some cycles later than its match, but delays do not accumulate.
 *
 *   compare match     |               |               |
 *   polled        ^  ^  ^               ^  ^  ^  ^  ^  ^
 *   pin           ~~~~~~|___start bit___|_____bit 0____|~~
 *
 * Before packet BUSY_BEFORE the host is busy for the time that an ATmega needs to write a byte of its EEPROM, longer than
 * a tick. The packet after it is on time again, but the queue of the device has run empty, so all later ticks are late.
 */
#include <avr/io.h>
#include <avr/sleep.h>
#include <util/delay.h>

#include "packets.h"

/* Port B: the line to the device, and a pin that is high while the host is busy */
#define LINE _BV(PORTB0)
#define BUSY _BV(PORTB1)

/* Cycles from the start of the program to the first packet */
#define LEAD_CYCLES 8000u

/* A wait instead of a write, because simavr 1.6 writes in no time. */
#define BUSY_BEFORE 24
#define BUSY_US 3400

#if TICK_CYCLES > 32767
#error "lateness of a packet is computed with signed 16 bits: use a scenario with ticks of at most 32767 cycles"
#endif

static void wait_for_match(void)
{
    loop_until_bit_is_set(TIFR1, OCF1A);
    TIFR1 = _BV(OCF1A);
}

/* Sends a byte whose start bit begins at the current match; afterwards the match is the end of its stop bit. */
static void send(uint8_t byte)
{
    uint16_t frame = 0x200 | byte << 1;
    for (uint8_t bit = 0; bit < 10; bit++) {
        wait_for_match();
        OCR1A += BIT_CYCLES;
        if (frame & 1)
            PORTB |= LINE;
        else
            PORTB &= ~LINE;
        frame >>= 1;
    }
}

/* Sets the next match to the due cycle of a packet, or shortly ahead if that has passed. */
static void begin_at(uint16_t due)
{
    OCR1A = due;
    TIFR1 = _BV(OCF1A);
    if ((int16_t)(due - TCNT1) < BIT_CYCLES) {
        OCR1A = TCNT1 + BIT_CYCLES;
        TIFR1 = _BV(OCF1A);
    }
}

int main(void)
{
    uint16_t due = LEAD_CYCLES;
    /* High before it becomes an output, like the line's pull-up. */
    PORTB = LINE;
    DDRB = LINE | BUSY;
    TCCR1B = _BV(CS10);

    for (uint16_t packet = 0; packet < PACKETS; packet++, due += TICK_CYCLES) {
        if (packet == BUSY_BEFORE) {
            PORTB |= BUSY;
            _delay_us(BUSY_US);
            PORTB &= ~BUSY;
        }
        begin_at(due);
        for (uint8_t byte = 0; byte < PACKET_BYTES; byte++)
            send(pgm_read_byte(&packets[packet][byte]));
    }
    begin_at(due);
    wait_for_match();
    PORTB |= BUSY;

    /* Sleeps forever. */
    sleep_enable();
    sleep_cpu();
}
