/*
 * The framed line (DESIGN A6) on the ATmega328P's UART: receives bytes, returns valid frames, and sends replies.
 *
 *   RXD ──> ring ──> COBS, CRC-32C ──> frame_arrived
 *           (interrupt)  (main loop)
 *   TXD <── COBS, CRC-32C <── line_send
 */
#ifndef FRAMED_LINE_H
#define FRAMED_LINE_H

#include <stdint.h>

/* Exact at 16 MHz. */
#define BAUD 250000

/* The rest of a longer body is checked but not stored: no kind has one. */
#define BODY_KEPT 66

/* Fault flags of the line */
enum line_fault {
    FRAMING = 1 << 0,
    SHORT_FRAME = 1 << 1,
    CRC = 1 << 2,
    OVERLONG = 1 << 3,
};

void line_begin(void);

/* Processes the received bytes, or sleeps until an interrupt. */
void line_hear(void);

/* Sends a frame of fewer than 250 bytes; the buffer has space for its CRC. */
void line_send(uint8_t *frame, uint8_t length);

/* Implemented by the program: a valid frame without its CRC, at least address and kind. */
void frame_arrived(const uint8_t *frame, uint16_t length);

/* Implemented by the program: sets a flag. */
void fault(uint16_t flag);

#endif
