/*
 * Sends raw packets at a fixed pace: the host of a line, on an ATmega328P at 16 MHz.
 *
 * packets.h holds what the scenario's own host would send: PACKETS packets of PACKET_BYTES bytes, a packet every
 * TICK_CYCLES, each bit BIT_CYCLES long, 8N1.
 *
 * Timer1 counts the processor's cycles and is never set back. The pin is set by the program, which looks for the compare
 * match of each bit in a loop: an edge comes some cycles after its match, but no delay adds to the next one's.
 *
 *   compare match     |               |               |
 *   looked at     ^  ^  ^               ^  ^  ^  ^  ^  ^
 *   pin           ~~~~~~|___start bit___|_____bit 0____|~~
 *
 * Before packet BUSY_BEFORE the host is busy for as long as an ATmega writes a byte of its EEPROM: longer than a tick. The
 * packet after it is on time again, but by then the device has rested, and all that follows comes that much later.
 */
#include <avr/io.h>
#include <avr/sleep.h>
#include <util/delay.h>

#include "packets.h"

/* Port B: the line as the device hears it, and when the host has something else to do */
#define LINE _BV(PORTB0)
#define BUSY _BV(PORTB1)

/* From the start of the program to the first packet */
#define LEAD_CYCLES 8000u

/* A wait and no real writing: simavr 1.6 writes in no time. */
#define BUSY_BEFORE 24
#define BUSY_US 3400

#if TICK_CYCLES > 32767
#error "whether a packet is late is told by 16 bits with a sign: give a scenario with ticks of at most 32767 cycles"
#endif

static void wait_for_match(void)
{
    loop_until_bit_is_set(TIFR1, OCF1A);
    TIFR1 = _BV(OCF1A);
}

/* Sends a byte whose start bit begins at the match that is set; the next match is then the end of its stop bit. */
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

/* Sets the next match to the cycle in which a packet is due, or shortly ahead where that is over. */
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
    /* High before it is an output, as the line's pull-up has it. */
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

    /* Asleep for good. */
    sleep_enable();
    sleep_cpu();
}
