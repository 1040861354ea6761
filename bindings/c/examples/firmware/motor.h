/* A driver of channel 0 by registers. On the chip, bus_read() and bus_write() are volatile accesses. */
#ifndef MOTOR_H
#define MOTOR_H

#include <stdbool.h>
#include <stdint.h>

uint32_t bus_read(uint32_t offset);
void bus_write(uint32_t offset, uint32_t value);

/* Queues a tick of `steps` steps, -127 to 127, right positive; false if it is refused: still in the self-test, or no place. */
bool motor_queue(int8_t steps);

/* Steps since reset, right positive. */
int32_t motor_position(void);

#endif
