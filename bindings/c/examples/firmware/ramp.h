/* A trapezoidal move: 2000 steps, speeding up at 10000 steps/s^2 to 4000 steps/s and slowing down to rest. */
#ifndef RAMP_H
#define RAMP_H

#include <stdint.h>

#define RAMP_CLOCK_HZ UINT64_C(16000000)
#define RAMP_STEPS 2000U
#define RAMP_SPEED_STEPS_S 4000U
#define RAMP_ACCELERATION_STEPS_S2 10000U

/* Time of step `index`, which counts from 0, in clock cycles from the start of the move. */
uint64_t ramp_step_cycles(uint32_t index);

#endif
