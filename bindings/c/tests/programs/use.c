/* Each function as it is meant to be used. */
#include <stepscope.h>
#include <string.h>

#include "check.h"

static const char TURN[] = "{\"source\":{\"motion\":{\"axes\":[{\"moves\":[{\"cosine\":{\"distance\":{\"deg\":360},"
                           "\"duration_s\":0.4,\"ramp_s\":0.2}}]}]}}}";
static const char FRAMED[] = "{\"line\":{\"protocol\":\"framed\",\"address\":7}}";

static stepscope_scenario *scenario_of(const char *json) {
    stepscope_scenario *scenario = NULL;
    CHECK(stepscope_scenario_from_json(json, STEPSCOPE_TO_ZERO, &scenario, NULL) == STEPSCOPE_OK);
    return scenario;
}

static stepscope_run *run_of(const char *json) {
    stepscope_run *run = NULL;
    stepscope_scenario *scenario = scenario_of(json);
    CHECK(stepscope_run_scenario(scenario, NULL, &run, NULL) == STEPSCOPE_OK);
    CHECK(stepscope_scenario_free(scenario) == STEPSCOPE_OK);
    return run; /* it outlives its scenario */
}

static void versions(void) {
    CHECK(strcmp(stepscope_version(), STEPSCOPE_VERSION) == 0);
    CHECK(stepscope_abi() == STEPSCOPE_ABI);
    CHECK(strcmp(stepscope_status_text(STEPSCOPE_OK), "no error") == 0);
    CHECK(strcmp(stepscope_status_text(99), "unknown status") == 0);
}

static void scenarios(void) {
    stepscope_scenario *scenario = NULL;
    stepscope_error *error = NULL;
    CHECK(stepscope_scenario_from_json("{} and more", 2, &scenario, &error) == STEPSCOPE_OK);
    CHECK(scenario != NULL && error == NULL);
    CHECK(stepscope_scenario_free(scenario) == STEPSCOPE_OK);
    CHECK(stepscope_scenario_from_preset("song-2021-one-turn", &scenario, &error) == STEPSCOPE_OK);
    CHECK(stepscope_scenario_free(scenario) == STEPSCOPE_OK);

    FILE *file = fopen("use.json", "w");
    CHECK(file != NULL && fputs(TURN, file) >= 0 && fclose(file) == 0);
    CHECK(stepscope_scenario_from_file("use.json", &scenario, &error) == STEPSCOPE_OK);
    CHECK(stepscope_scenario_free(scenario) == STEPSCOPE_OK && remove("use.json") == 0);
    CHECK(stepscope_scenario_free(NULL) == STEPSCOPE_OK);
}

static void runs(void) {
    stepscope_run *run = run_of(TURN);
    stepscope_summary summary = STEPSCOPE_SUMMARY;
    CHECK(stepscope_run_summary(run, 0, &summary) == STEPSCOPE_OK);
    CHECK(summary.size == sizeof summary && summary.controllers == 1 && summary.channels == 1);
    CHECK(summary.clock_hz == 16000000 && summary.positions[0] == 3200 && summary.positions[1] == 0);
    CHECK(summary.faults == 0 && summary.ticks_done > 0 && summary.cycles > 6400000);

    const stepscope_edge *edges = NULL;
    size_t count = 0;
    CHECK(stepscope_run_edges(run, 0, &edges, &count) == STEPSCOPE_OK);
    CHECK(count == summary.records && edges[0].cycle == 0);
    CHECK((edges[0].levels & STEPSCOPE_LEVEL_EN) != 0 && (edges[0].levels & STEPSCOPE_LEVEL_STEP(0)) == 0);
    size_t rises = 0;
    for (size_t i = 1; i < count; ++i) {
        CHECK(edges[i - 1].cycle < edges[i].cycle && edges[i - 1].levels != edges[i].levels);
        rises += (edges[i].levels & ~edges[i - 1].levels & STEPSCOPE_LEVEL_STEP(0)) != 0;
    }
    CHECK(rises == 3200);

    stepscope_step *steps = NULL;
    CHECK(stepscope_run_steps(run, 0, 0, NULL, 0, &count) == STEPSCOPE_OK && count == 3200);
    steps = calloc(count, sizeof *steps);
    CHECK(steps != NULL && stepscope_run_steps(run, 0, 0, steps, count, &count) == STEPSCOPE_OK);
    for (size_t i = 0; i < count; ++i) {
        CHECK(steps[i].direction == 1 && steps[i].reserved == 0);
    }
    CHECK(stepscope_run_steps(run, 0, 15, NULL, 0, &count) == STEPSCOPE_OK && count == 0);

    stepscope_error *error = NULL;
    CHECK(stepscope_run_write_vcd(run, 0, "use.vcd", &error) == STEPSCOPE_OK && error == NULL);
    char line[16] = "";
    FILE *file = fopen("use.vcd", "r");
    CHECK(file != NULL && fgets(line, sizeof line, file) != NULL && fclose(file) == 0 && remove("use.vcd") == 0);
    CHECK(strncmp(line, "$timescale", 10) == 0);
    free(steps);
    CHECK(stepscope_run_free(run) == STEPSCOPE_OK);
}

typedef struct {
    uint64_t last;
    uint64_t stop_at;
    unsigned calls;
} Progress;

static bool on_progress(void *context, uint64_t cycles) {
    Progress *progress = context;
    CHECK(progress->calls == 0 ? cycles == 0 : cycles >= progress->last);
    progress->last = cycles;
    ++progress->calls;
    return cycles < progress->stop_at;
}

static void options(void) {
    stepscope_scenario *scenario = scenario_of(TURN);
    stepscope_run *run = NULL;
    stepscope_run *bare = NULL;
    Progress progress = {0, UINT64_MAX, 0};
    stepscope_run_options options = STEPSCOPE_RUN_OPTIONS;
    options.keep_edges = false;
    options.progress = on_progress;
    options.context = &progress;
    CHECK(stepscope_run_scenario(scenario, NULL, &run, NULL) == STEPSCOPE_OK);
    CHECK(stepscope_run_scenario(scenario, &options, &bare, NULL) == STEPSCOPE_OK);
    stepscope_summary one = STEPSCOPE_SUMMARY, other = STEPSCOPE_SUMMARY;
    CHECK(stepscope_run_summary(run, 0, &one) == STEPSCOPE_OK);
    CHECK(stepscope_run_summary(bare, 0, &other) == STEPSCOPE_OK);
    CHECK(memcmp(&one, &other, sizeof one) == 0 && progress.calls >= 2 && progress.last == one.cycles);
    CHECK(stepscope_run_free(run) == STEPSCOPE_OK && stepscope_run_free(bare) == STEPSCOPE_OK);

    progress = (Progress){0, 1, 0};
    stepscope_error *error = NULL;
    CHECK(stepscope_run_scenario(scenario, &options, &run, &error) == STEPSCOPE_STOPPED);
    CHECK(run == NULL && progress.calls == 2 && strstr(stepscope_error_text(error), "stopped") != NULL);
    CHECK(stepscope_error_free(error) == STEPSCOPE_OK && stepscope_scenario_free(scenario) == STEPSCOPE_OK);
}

static void step_lists(void) {
    stepscope_scenario *scenario = scenario_of(TURN);
    size_t count = 0;
    CHECK(stepscope_step_times(scenario, 0, 0, NULL, 0, &count, NULL) == STEPSCOPE_OK && count == 3200);
    stepscope_step *due = calloc(count, sizeof *due);
    CHECK(due != NULL && stepscope_step_times(scenario, 0, 0, due, count, &count, NULL) == STEPSCOPE_OK);
    CHECK(due[0].cycle > 0 && due[3199].cycle < 6400000 && due[7].direction == 1);

    size_t index = 0;
    CHECK(stepscope_first_difference(due, count, due, count, 0, &index) == STEPSCOPE_OK && index == STEPSCOPE_NONE);
    CHECK(stepscope_first_difference(due, count, due, count - 1, 0, &index) == STEPSCOPE_OK && index == count - 1);
    CHECK(stepscope_first_difference(NULL, 0, NULL, 0, 0, &index) == STEPSCOPE_OK && index == STEPSCOPE_NONE);
    const stepscope_step a[] = {{100, 1, 0}, {200, 1, 0}}, b[] = {{100, 1, 0}, {216, 1, 0}}, c[] = {{100, 1, 0}, {200, -1, 0}};
    CHECK(stepscope_first_difference(a, 2, b, 2, 16, &index) == STEPSCOPE_OK && index == STEPSCOPE_NONE);
    CHECK(stepscope_first_difference(a, 2, b, 2, 15, &index) == STEPSCOPE_OK && index == 1);
    CHECK(stepscope_first_difference(a, 2, c, 2, UINT64_MAX, &index) == STEPSCOPE_OK && index == 1);
    free(due);
    CHECK(stepscope_scenario_free(scenario) == STEPSCOPE_OK);
}

static void count_edge(void *context, stepscope_edge edge) {
    unsigned *edges = context;
    CHECK(edge.levels != 0);
    ++*edges;
}

/* Five steps to the right by registers. */
static void device_by_registers(void) {
    stepscope_device *device = NULL;
    CHECK(stepscope_device_new(NULL, 0, &device, NULL) == STEPSCOPE_OK);
    uint32_t value = 0;
    uint64_t cycles = 1, levels = 0;
    unsigned edges = 0;
    CHECK(stepscope_device_read(device, STEPSCOPE_REG_ID, &value) == STEPSCOPE_OK && value == 0x53544550);
    CHECK(stepscope_device_watch(device, count_edge, &edges) == STEPSCOPE_OK);
    CHECK(stepscope_device_cycles_until_event(device, &cycles) == STEPSCOPE_OK && cycles == 0);
    CHECK(stepscope_device_clock(device, true, &levels) == STEPSCOPE_OK);
    CHECK(levels == (STEPSCOPE_LEVEL_EN | STEPSCOPE_LEVEL_RX | STEPSCOPE_LEVEL_TX) && edges == 1);
    CHECK(stepscope_device_clock(device, true, NULL) == STEPSCOPE_OK);
    CHECK(stepscope_device_run_until(device, 2000, true) == STEPSCOPE_OK);
    CHECK(stepscope_device_write(device, STEPSCOPE_REG_ORDERS, 0x85) == STEPSCOPE_OK);
    CHECK(stepscope_device_write(device, STEPSCOPE_REG_PUSH, 1) == STEPSCOPE_OK);
    CHECK(stepscope_device_cycles_until_event(device, &cycles) == STEPSCOPE_OK && cycles != STEPSCOPE_NEVER);
    CHECK(stepscope_device_advance(device, cycles) == STEPSCOPE_OK);
    CHECK(stepscope_device_watch(device, NULL, NULL) == STEPSCOPE_OK);
    CHECK(stepscope_device_run_until(device, 42000, true) == STEPSCOPE_OK && edges <= 2);
    CHECK(stepscope_device_read(device, STEPSCOPE_REG_POSITION, &value) == STEPSCOPE_OK && value == 5);
    stepscope_summary summary = STEPSCOPE_SUMMARY;
    CHECK(stepscope_device_summary(device, &summary) == STEPSCOPE_OK);
    CHECK(summary.controllers == 1 && summary.cycles == 42000 && summary.positions[0] == 5);
    CHECK(summary.ticks_done == 1 && summary.records == 1 + 1 + 10 && summary.clock_hz == 16000000);
    CHECK(stepscope_device_cycles_until_event(device, &cycles) == STEPSCOPE_OK && cycles == STEPSCOPE_NEVER);
    CHECK(stepscope_device_free(device) == STEPSCOPE_OK);
}

static void device_by_frames(void) {
    uint8_t frame[604], reply[600], body[600], address = 0, kind = 0;
    size_t count = 0, length = 0;
    stepscope_scenario *scenario = scenario_of(FRAMED);
    stepscope_device *device = NULL;
    CHECK(stepscope_device_new(scenario, 0, &device, NULL) == STEPSCOPE_OK);
    CHECK(stepscope_scenario_free(scenario) == STEPSCOPE_OK);
    CHECK(stepscope_encode_frame(7, 7, NULL, 0, NULL, 0, &length) == STEPSCOPE_OK && length == 8);
    CHECK(stepscope_encode_frame(7, 7, NULL, 0, frame, sizeof frame, &length) == STEPSCOPE_OK && frame[7] == 0);

    CHECK(stepscope_device_send(device, frame, length) == STEPSCOPE_OK);
    CHECK(stepscope_device_receive(device, 100000, NULL, 0, &count) == STEPSCOPE_OK && count == 21);
    CHECK(stepscope_device_receive(device, 100000, reply, sizeof reply, &count) == STEPSCOPE_OK && count == 21);
    CHECK(stepscope_decode_frame(reply, count, &address, &kind, body, sizeof body, &length) == STEPSCOPE_OK);
    CHECK(address == 7 && kind == 0x87 && length == 13);
    CHECK(stepscope_decode_frame(reply, count - 1, &address, &kind, body, sizeof body, &length) == STEPSCOPE_OK);

    /* DE is low again behind the reply, and none follows. */
    stepscope_summary before = STEPSCOPE_SUMMARY, after = STEPSCOPE_SUMMARY;
    uint64_t levels = 0;
    CHECK(stepscope_device_summary(device, &before) == STEPSCOPE_OK);
    CHECK(stepscope_device_receive(device, 1000, reply, sizeof reply, &count) == STEPSCOPE_OK && count == 0);
    CHECK(stepscope_device_receive(device, STEPSCOPE_NEVER, reply, sizeof reply, &count) == STEPSCOPE_OK && count == 0);
    CHECK(stepscope_device_summary(device, &after) == STEPSCOPE_OK && after.cycles == before.cycles + 1000);
    CHECK(stepscope_device_clock(device, true, &levels) == STEPSCOPE_OK && (levels & STEPSCOPE_LEVEL_DE) == 0);
    CHECK(after.records == before.records);

    /* Two replies wait, the oldest comes first. A timeout that is too short is none, and the reply is not lost. */
    CHECK(stepscope_encode_frame(7, 4, NULL, 0, frame, sizeof frame, &length) == STEPSCOPE_OK);
    CHECK(stepscope_device_send(device, frame, length) == STEPSCOPE_OK);
    CHECK(stepscope_device_receive(device, 1, reply, sizeof reply, &count) == STEPSCOPE_OK && count == 0);
    CHECK(stepscope_device_run_until(device, after.cycles + 200000, true) == STEPSCOPE_OK);
    CHECK(stepscope_encode_frame(7, 6, NULL, 0, frame, sizeof frame, &length) == STEPSCOPE_OK);
    CHECK(stepscope_device_send(device, frame, length) == STEPSCOPE_OK);
    for (unsigned expected = 0x84; expected <= 0x86; expected += 2) {
        CHECK(stepscope_device_receive(device, STEPSCOPE_NEVER, reply, sizeof reply, &count) == STEPSCOPE_OK);
        CHECK(stepscope_decode_frame(reply, count, &address, &kind, body, sizeof body, &length) == STEPSCOPE_OK);
        CHECK(kind == expected);
    }
    CHECK(stepscope_device_free(device) == STEPSCOPE_OK);
}

/* One look at the end of a chain is enough: the first error is kept. */
static void chain_of_errors(void) {
    stepscope_error *error = NULL;
    stepscope_scenario *scenario = NULL;
    stepscope_run *run = NULL;
    CHECK(stepscope_scenario_from_json("{\"bus\":{\"slot\":1,\"slots\":0},\"title\":5}", STEPSCOPE_TO_ZERO, &scenario,
                                       &error) == STEPSCOPE_PROBLEMS);
    stepscope_error *first = error;
    CHECK(stepscope_run_scenario(scenario, NULL, &run, &error) == STEPSCOPE_NULL && error == first && run == NULL);
    CHECK(stepscope_error_count(error) == 3);
    CHECK(strcmp(stepscope_error_path(error, 0), "bus.slot") == 0);
    CHECK(strcmp(stepscope_error_path(error, 2), "bus.slots") == 0);
    CHECK(strcmp(stepscope_error_message(error, 2), "0 is out of range; use 1 to 127") == 0);
    CHECK(stepscope_error_path(error, 3) == NULL && stepscope_error_message(error, 3) == NULL);
    CHECK(strstr(stepscope_error_text(error), "\nbus.slots: 0 is out of range; use 1 to 127") != NULL);
    CHECK(stepscope_error_free(error) == STEPSCOPE_OK);

    error = NULL;
    scenario = scenario_of("{\"clock_hz\":3,\"bus\":{\"slots\":0}}"); /* it reads; the run refuses it */
    CHECK(stepscope_run_scenario(scenario, NULL, &run, &error) == STEPSCOPE_PROBLEMS);
    CHECK(stepscope_error_count(error) == 2);
    CHECK(stepscope_error_free(error) == STEPSCOPE_OK && stepscope_scenario_free(scenario) == STEPSCOPE_OK);
}

int main(void) {
    versions();
    scenarios();
    runs();
    options();
    step_lists();
    device_by_registers();
    device_by_frames();
    chain_of_errors();
    CHECK(stepscope_live() == 0);
    puts("each function works");
    return 0;
}
