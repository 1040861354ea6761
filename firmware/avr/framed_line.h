/*
 * The framed line (DESIGN A6) on the ATmega328P's UART: bytes in, good frames out, and replies.
 *
 *   RXD ──> ring ──> COBS, CRC-32C ──> frame_arrived
 *           (interrupt)  (main loop)
 *   TXD <── COBS, CRC-32C <── line_send
 */
#ifndef FRAMED_LINE_H
#define FRAMED_LINE_H

#include <stdint.h>

/* 16 MHz has it exactly. */
#define BAUD 250000

/* Of a longer body the rest is looked at and not kept: no kind has one. */
#define BODY_KEPT 66

/* Fault flags of the line */
enum line_fault {
    FRAMING = 1 << 0,
    SHORT_FRAME = 1 << 1,
    CRC = 1 << 2,
    OVERLONG = 1 << 3,
};

void line_begin(void);

/* Takes what has been heard, or sleeps until an interrupt. */
void line_hear(void);

/* Sends a frame of fewer than 250 bytes; there is room behind it for its check. */
void line_send(uint8_t *frame, uint8_t length);

/* The program's: a good frame without its check, at least address and kind. */
void frame_arrived(const uint8_t *frame, uint16_t length);

/* The program's: a flag to be set. */
void fault(uint16_t flag);

#endif
