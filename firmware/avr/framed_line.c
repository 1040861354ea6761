/*
 * The framed line: framed_line.h.
 */
#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/pgmspace.h>
#include <avr/sleep.h>
#include <stdbool.h>
#include <string.h>

#include "framed_line.h"

/* ---- CRC-32C, reflected, four bits at a time ---- */

#define CRC_BEGIN 0xffffffffu
/* The CRC of a message followed by its CRC. */
#define CRC_RESIDUE 0xb798b438u

static const uint32_t crc_of_nibble[16] PROGMEM = {
    0x00000000, 0x105ec76f, 0x20bd8ede, 0x30e349b1, 0x417b1dbc, 0x5125dad3, 0x61c69362, 0x7198540d,
    0x82f63b78, 0x92a8fc17, 0xa24bb5a6, 0xb21572c9, 0xc38d26c4, 0xd3d3e1ab, 0xe330a81a, 0xf36e6f75,
};

static uint32_t crc_next(uint32_t crc, uint8_t byte)
{
    crc ^= byte;
    crc = crc >> 4 ^ pgm_read_dword(&crc_of_nibble[crc & 15]);
    return crc >> 4 ^ pgm_read_dword(&crc_of_nibble[crc & 15]);
}

/* ---- to the host ---- */

static void put(uint8_t byte)
{
    loop_until_bit_is_set(UCSR0A, UDRE0);
    UDR0 = byte;
}

void line_send(uint8_t *frame, uint8_t length)
{
    uint32_t crc = CRC_BEGIN;
    for (uint8_t i = 0; i < length; i++)
        crc = crc_next(crc, frame[i]);
    crc = ~crc;
    memcpy(frame + length, &crc, 4);
    length += 4;
    for (uint8_t begin = 0; begin <= length;) {
        uint8_t end = begin;
        while (end < length && frame[end])
            end++;
        put(end - begin + 1);
        while (begin < end)
            put(frame[begin++]);
        begin++;
    }
    put(0);
}

/* ---- from the host: COBS, byte by byte ---- */

/* Maximum and minimum decoded bytes of a frame. */
#define FRAME_MAX 600
#define FRAME_MIN 6
#define CHECK_BYTES 4

static uint8_t frame[2 + BODY_KEPT];
static uint16_t length;
static uint32_t crc = CRC_BEGIN;
static uint8_t left;
static bool has_begun, owes_zero;

static void decoded(uint8_t byte)
{
    if (length < sizeof frame)
        frame[length] = byte;
    if (length <= FRAME_MAX && ++length > FRAME_MAX)
        fault(OVERLONG);
    crc = crc_next(crc, byte);
}

static void end_frame(void)
{
    if (!has_begun || length > FRAME_MAX)
        return;
    if (left > 0 || length < FRAME_MIN)
        fault(SHORT_FRAME);
    else if (crc != CRC_RESIDUE)
        fault(CRC);
    else
        frame_arrived(frame, length - CHECK_BYTES);
}

static void hear(uint8_t byte)
{
    if (byte == 0) {
        end_frame();
        has_begun = owes_zero = false;
        left = length = 0;
        crc = CRC_BEGIN;
    } else if (left > 0) {
        left--;
        decoded(byte);
    } else {
        if (owes_zero)
            decoded(0);
        has_begun = true;
        owes_zero = byte != 255;
        left = byte - 1;
    }
}

/* The counters wrap at this length. */
static volatile uint8_t ring[256], heard, taken;

ISR(USART_RX_vect)
{
    uint8_t status = UCSR0A, byte = UDR0;
    if (status & _BV(FE0))
        fault(FRAMING); /* The byte is missing, so the CRC of its frame is wrong. */
    else if ((uint8_t)(heard + 1) != taken)
        ring[heard++] = byte;
}

void line_begin(void)
{
    UBRR0 = F_CPU / 16 / BAUD - 1;
    UCSR0B = _BV(RXEN0) | _BV(TXEN0) | _BV(RXCIE0);
    set_sleep_mode(SLEEP_MODE_IDLE);
}

void line_hear(void)
{
    cli();
    if (heard == taken) {
        /* No interrupt can occur between these two, so the next one wakes the chip. */
        sleep_enable();
        sei();
        sleep_cpu();
        sleep_disable();
    }
    sei();
    while (heard != taken)
        hear(ring[taken++]);
}
