/* Prints the digest of each controller of scenarios: files that end in .json, or presets. */
#include <inttypes.h>
#include <stepscope.h>
#include <string.h>

#include "check.h"

int main(int count, char **files) {
    for (int i = 1; i < count; ++i) {
        stepscope_error *error = NULL;
        stepscope_scenario *scenario = NULL;
        stepscope_run *run = NULL;
        stepscope_run_options options = STEPSCOPE_RUN_OPTIONS;
        options.keep_edges = i % 2 != 0;
        if (strstr(files[i], ".json") != NULL) {
            stepscope_scenario_from_file(files[i], &scenario, &error);
        } else {
            stepscope_scenario_from_preset(files[i], &scenario, &error);
        }
        stepscope_run_scenario(scenario, &options, &run, &error);
        if (error != NULL) {
            fprintf(stderr, "%s: %s\n", files[i], stepscope_error_text(error));
            return 1;
        }
        stepscope_summary summary = STEPSCOPE_SUMMARY;
        for (uint32_t k = 0; k == 0 || k < summary.controllers; ++k) {
            CHECK(stepscope_run_summary(run, k, &summary) == STEPSCOPE_OK);
            printf("%s%016" PRIx64, k == 0 ? "" : " ", summary.digest);
        }
        putchar('\n');
        stepscope_run_free(run), stepscope_scenario_free(scenario);
    }
    return 0;
}
