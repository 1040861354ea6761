/* Step k, which counts from 1, is due where the position is k - 1/2 steps, so that the mean position error is 0:
 *
 *   speeding up    t = sqrt((2k - 1) / a)
 *   at full speed  t = v/a + (k - 1/2 - v^2/2a) / v
 *   slowing down   as speeding up, counted from the end
 */
#include "ramp.h"

#define RAMP_UP_STEPS (RAMP_SPEED_STEPS_S * RAMP_SPEED_STEPS_S / (2U * RAMP_ACCELERATION_STEPS_S2))
#define RAMP_UP_CYCLES (RAMP_CLOCK_HZ * RAMP_SPEED_STEPS_S / RAMP_ACCELERATION_STEPS_S2)
#define FULL_SPEED_CYCLES ((RAMP_STEPS - 2U * RAMP_UP_STEPS) * RAMP_CLOCK_HZ / RAMP_SPEED_STEPS_S)

/* The square root, rounded down: one bit of the result per round. */
static uint64_t square_root(uint64_t value) {
    uint64_t root = 0;
    for (uint64_t bit = UINT64_C(1) << 31; bit != 0; bit >>= 1) {
        const uint64_t next = root | bit;
        if (next * next <= value) {
            root = next;
        }
    }
    return root;
}

/* Time to cover half_steps/2 steps from rest. */
static uint64_t from_rest(uint64_t half_steps) {
    return square_root(half_steps * (RAMP_CLOCK_HZ * RAMP_CLOCK_HZ / RAMP_ACCELERATION_STEPS_S2));
}

uint64_t ramp_step_cycles(uint32_t index) {
    const uint64_t half_steps = 2U * (uint64_t)index + 1U;
    if (index < RAMP_UP_STEPS) {
        return from_rest(half_steps);
    }
    if (index < RAMP_STEPS - RAMP_UP_STEPS) {
        return RAMP_UP_CYCLES + (half_steps - 2U * RAMP_UP_STEPS) * RAMP_CLOCK_HZ / (2U * RAMP_SPEED_STEPS_S);
    }
    return 2U * RAMP_UP_CYCLES + FULL_SPEED_CYCLES - from_rest(2U * RAMP_STEPS - half_steps);
}
