/* The driver against the model of the peripheral: what it makes of STEP and DIR, edge by edge. */
#include <inttypes.h>
#include <stdio.h>
#include <stepscope.h>

#include "motor.h"

#define CHECK(condition) ((condition) ? 0 : (fprintf(stderr, "line %d: not true: %s\n", __LINE__, #condition), 1))

static stepscope_device *device;

/* An access takes a cycle, as on the chip. */
uint32_t bus_read(uint32_t offset) {
    uint32_t value = 0;
    stepscope_device_clock(device, true, NULL);
    stepscope_device_read(device, offset, &value);
    return value;
}

void bus_write(uint32_t offset, uint32_t value) {
    stepscope_device_clock(device, true, NULL);
    stepscope_device_write(device, offset, value);
}

typedef struct {
    uint64_t levels;
    int right, left; /* rises of STEP with DIR high and low */
    int late_turns;  /* changes of DIR while STEP is high */
} Pins;

static void on_edge(void *context, stepscope_edge edge) {
    Pins *pins = context;
    const uint64_t changed = edge.levels ^ pins->levels;
    if ((changed & edge.levels & STEPSCOPE_LEVEL_STEP(0)) != 0) {
        *((edge.levels & STEPSCOPE_LEVEL_DIR(0)) != 0 ? &pins->right : &pins->left) += 1;
    }
    pins->late_turns += (changed & STEPSCOPE_LEVEL_DIR(0)) != 0 && (edge.levels & STEPSCOPE_LEVEL_STEP(0)) != 0;
    pins->levels = edge.levels;
}

int main(void) {
    Pins pins = {0, 0, 0, 0};
    stepscope_summary summary = STEPSCOPE_SUMMARY;
    int failures = CHECK(stepscope_device_new(NULL, 0, &device, NULL) == STEPSCOPE_OK);
    failures += CHECK(stepscope_device_watch(device, on_edge, &pins) == STEPSCOPE_OK);
    failures += CHECK(!motor_queue(5)); /* refused during the self-test */
    failures += CHECK(stepscope_device_run_until(device, 10000, true) == STEPSCOPE_OK);
    failures += CHECK(motor_queue(5));
    failures += CHECK(motor_queue(-3));
    failures += CHECK(stepscope_device_run_until(device, 200000, true) == STEPSCOPE_OK);
    failures += CHECK(stepscope_device_summary(device, &summary) == STEPSCOPE_OK);
    failures += CHECK(motor_position() == 2);
    failures += CHECK(pins.right == 5 && pins.left == 3 && pins.late_turns == 0);
    failures += CHECK(summary.ticks_done == 2 && summary.faults == 0);
    failures += CHECK(stepscope_device_free(device) == STEPSCOPE_OK && stepscope_live() == 0);
    return failures == 0 ? 0 : 1;
}
