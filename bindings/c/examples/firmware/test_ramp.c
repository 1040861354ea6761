/* The step generator against the plan of the same move, step by step. */
#include <inttypes.h>
#include <stdio.h>
#include <stepscope.h>

#include "ramp.h"

/* The plan is rounded to the nearest cycle, the generator down. */
#define WITHIN_CYCLES 1U

int main(void) {
    static stepscope_step expected[RAMP_STEPS], found[RAMP_STEPS];
    stepscope_scenario *scenario = NULL;
    stepscope_error *error = NULL;
    size_t count = 0, index = 0;
    stepscope_scenario_from_file("ramp.json", &scenario, &error);
    stepscope_step_times(scenario, 0, 0, expected, RAMP_STEPS, &count, &error);
    stepscope_scenario_free(scenario);
    if (error != NULL) {
        fprintf(stderr, "%s\n", stepscope_error_text(error));
        stepscope_error_free(error);
        return 1;
    }
    for (uint32_t i = 0; i < RAMP_STEPS; ++i) {
        found[i].cycle = ramp_step_cycles(i);
        found[i].direction = 1;
    }
    stepscope_first_difference(expected, count, found, RAMP_STEPS, WITHIN_CYCLES, &index);
    if (index != STEPSCOPE_NONE) {
        fprintf(stderr, "step %zu of %zu: expected in cycle %" PRIu64 ", found in cycle %" PRIu64 "\n", index, count,
                index < count ? expected[index].cycle : 0, index < RAMP_STEPS ? found[index].cycle : 0);
        return 1;
    }
    printf("%zu steps agree\n", count);
    return 0;
}
