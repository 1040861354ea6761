/* Wrong use of each function: a status, never a crash. */
#include <stepscope.h>
#include <string.h>

#include "check.h"

#define STATUS(expected, call) CHECK((call) == STEPSCOPE_##expected)

static stepscope_scenario *scenario;
static stepscope_run *run;
static stepscope_device *device;
static stepscope_error *error;

static void make(void) {
    STATUS(OK, stepscope_scenario_from_json("{}", 2, &scenario, NULL));
    STATUS(OK, stepscope_run_scenario(scenario, NULL, &run, NULL));
    STATUS(OK, stepscope_device_new(scenario, 0, &device, NULL));
    stepscope_scenario *none = NULL;
    STATUS(PROBLEMS, stepscope_scenario_from_json("7", 1, &none, &error));
    CHECK(none == NULL && error != NULL && stepscope_live() == 4);
}

/* All functions with one handle in each place. Those that are of the right kind are left out by the caller. */
static void wrong_handle(void *handle, stepscope_status expected) {
    stepscope_summary summary = STEPSCOPE_SUMMARY;
    stepscope_run *no_run = run;
    stepscope_device *no_device = device;
    const stepscope_edge *edges = NULL;
    const uint8_t byte = 0;
    size_t count = 0;
    uint64_t cycles = 0;
    uint32_t value = 0;
    stepscope_error *why = NULL;
    if (handle != (void *)scenario) {
        CHECK(stepscope_run_scenario(handle, NULL, &no_run, &why) == expected && no_run == NULL);
        CHECK(stepscope_error_count(why) == 1 && strcmp(stepscope_error_path(why, 0), "scenario") == 0);
        STATUS(OK, stepscope_error_free(why));
        CHECK(stepscope_step_times(handle, 0, 0, NULL, 0, &count, NULL) == expected);
    }
    if (handle != NULL && handle != (void *)scenario) { /* NULL: the defaults */
        CHECK(stepscope_device_new(handle, 0, &no_device, NULL) == expected && no_device == NULL);
        CHECK(stepscope_scenario_free(handle) == expected);
    }
    if (handle != (void *)run) {
        CHECK(stepscope_run_summary(handle, 0, &summary) == expected);
        CHECK(stepscope_run_edges(handle, 0, &edges, &count) == expected && edges == NULL && count == 0);
        CHECK(stepscope_run_steps(handle, 0, 0, NULL, 0, &count) == expected);
        CHECK(stepscope_run_write_vcd(handle, 0, "misuse.vcd", NULL) == expected);
        CHECK(handle == NULL || stepscope_run_free(handle) == expected);
    }
    if (handle != (void *)device) {
        CHECK(stepscope_device_clock(handle, true, &cycles) == expected);
        CHECK(stepscope_device_cycles_until_event(handle, &cycles) == expected);
        CHECK(stepscope_device_advance(handle, 0) == expected);
        CHECK(stepscope_device_run_until(handle, 1000, true) == expected);
        CHECK(stepscope_device_send(handle, &byte, 1) == expected);
        CHECK(stepscope_device_receive(handle, 0, NULL, 0, &count) == expected);
        CHECK(stepscope_device_read(handle, 0, &value) == expected);
        CHECK(stepscope_device_write(handle, 0, 0) == expected);
        CHECK(stepscope_device_summary(handle, &summary) == expected);
        CHECK(stepscope_device_watch(handle, NULL, NULL) == expected);
        CHECK(handle == NULL || stepscope_device_free(handle) == expected);
    }
    if (handle != (void *)error) {
        CHECK(stepscope_error_count(handle) == 0 && strcmp(stepscope_error_text(handle), "") == 0);
        CHECK(stepscope_error_path(handle, 0) == NULL && stepscope_error_message(handle, 0) == NULL);
        CHECK(handle == NULL || stepscope_error_free(handle) == expected);
    }
}

static void handles(void) {
    int on_stack = 0;
    void *on_heap = malloc(64);
    void *const all[] = {NULL,    &on_stack,      on_heap,       (void *)1, (void *)UINTPTR_MAX, "text",
                         scenario, (void *)run, (void *)device, error};
    for (size_t i = 0; i < sizeof all / sizeof *all; ++i) {
        wrong_handle(all[i], all[i] == NULL ? STEPSCOPE_NULL : STEPSCOPE_HANDLE);
    }
    free(on_heap);
    CHECK(stepscope_live() == 4);
}

static void used_up_handles(void) {
    void *const all[] = {scenario, run, device, error};
    STATUS(OK, stepscope_scenario_free(scenario));
    STATUS(OK, stepscope_run_free(run));
    STATUS(OK, stepscope_device_free(device));
    STATUS(OK, stepscope_error_free(error));
    STATUS(HANDLE, stepscope_scenario_free(scenario));
    STATUS(HANDLE, stepscope_run_free(run));
    STATUS(HANDLE, stepscope_device_free(device));
    STATUS(HANDLE, stepscope_error_free(error));
    scenario = NULL, run = NULL, device = NULL, error = NULL;
    make(); /* no name is given twice */
    for (size_t i = 0; i < sizeof all / sizeof *all; ++i) {
        wrong_handle(all[i], STEPSCOPE_HANDLE);
    }
}

static void texts(void) {
    stepscope_scenario *none = scenario;
    stepscope_error *why = NULL;
    STATUS(NULL, stepscope_scenario_from_json(NULL, 0, &none, &why));
    CHECK(none == NULL && strstr(stepscope_error_text(why), "json: ") == stepscope_error_text(why));
    STATUS(OK, stepscope_error_free(why));
    STATUS(NULL, stepscope_scenario_from_json("{}", 2, NULL, NULL));
    STATUS(UTF8, stepscope_scenario_from_json("\xff", 1, &none, NULL));
    STATUS(UTF8, stepscope_scenario_from_file("\xff", &none, NULL));
    STATUS(UTF8, stepscope_scenario_from_preset("\xff", &none, NULL));
    STATUS(PROBLEMS, stepscope_scenario_from_json("", 0, &none, NULL));
    STATUS(PROBLEMS, stepscope_scenario_from_json("{\"\\u0000\":1}", STEPSCOPE_TO_ZERO, &none, NULL));
    STATUS(PROBLEMS, stepscope_scenario_from_json("{\0}", 3, &none, NULL));
    STATUS(RANGE, stepscope_scenario_from_json("{}", SIZE_MAX - 1, &none, NULL));
    why = NULL;
    STATUS(FILE, stepscope_scenario_from_file("no/such/file.json", &none, &why));
    CHECK(strcmp(stepscope_error_path(why, 0), "no/such/file.json") == 0);
    STATUS(OK, stepscope_error_free(why));
    STATUS(FILE, stepscope_scenario_from_file(".", &none, NULL));
    why = NULL;
    STATUS(RANGE, stepscope_scenario_from_preset("no-such-preset", &none, &why));
    CHECK(strstr(stepscope_error_text(why), "song-2021-one-turn") != NULL && none == NULL);
    STATUS(OK, stepscope_error_free(why));
    why = NULL;
    STATUS(FILE, stepscope_run_write_vcd(run, 0, "no/such/folder.vcd", &why));
    CHECK(stepscope_error_count(why) == 1);
    STATUS(OK, stepscope_error_free(why));
    STATUS(NULL, stepscope_run_write_vcd(run, 0, NULL, NULL));
}

static void numbers(void) {
    stepscope_summary summary = STEPSCOPE_SUMMARY;
    stepscope_device *none = device;
    const stepscope_edge *edges = NULL;
    size_t count = 0;
    stepscope_error *why = NULL;
    STATUS(RANGE, stepscope_run_summary(run, 1, &summary));
    STATUS(RANGE, stepscope_run_edges(run, UINT32_MAX, &edges, &count));
    STATUS(RANGE, stepscope_run_steps(run, 1, 0, NULL, 0, &count));
    STATUS(RANGE, stepscope_run_steps(run, 0, 16, NULL, 0, &count));
    STATUS(RANGE, stepscope_run_write_vcd(run, 1, "misuse.vcd", NULL));
    STATUS(RANGE, stepscope_step_times(scenario, 0, 1, NULL, 0, &count, &why));
    CHECK(strcmp(stepscope_error_text(why), "axis: 1 is out of range; use 0") == 0);
    STATUS(RANGE, stepscope_step_times(scenario, 1, 0, NULL, 0, &count, &why));
    STATUS(OK, stepscope_error_free(why));
    STATUS(RANGE, stepscope_device_new(scenario, 1, &none, NULL));
    CHECK(none == NULL);
    stepscope_scenario *packets = NULL;
    STATUS(OK, stepscope_scenario_from_json("{\"source\":{\"packets\":{\"packets\":[\"83\"]}}}", STEPSCOPE_TO_ZERO, &packets, NULL));
    STATUS(PROBLEMS, stepscope_step_times(packets, 0, 0, NULL, 0, &count, NULL));
    STATUS(OK, stepscope_scenario_free(packets));
}

static void buffers(void) {
    stepscope_step few[3] = {{0, 0, 0}, {0, 0, 0}, {7, 7, 7}};
    size_t count = 99;
    STATUS(BUFFER, stepscope_run_steps(run, 0, 0, few, 2, &count));
    CHECK(count == 3200 && few[1].direction == 1 && few[2].cycle == 7);
    STATUS(BUFFER, stepscope_run_steps(run, 0, 0, few, 0, &count));
    STATUS(BUFFER, stepscope_step_times(scenario, 0, 0, few, 2, &count, NULL));
    CHECK(count == 3200 && few[2].cycle == 7);
    STATUS(NULL, stepscope_step_times(scenario, 0, 0, NULL, 5, &count, NULL));
    STATUS(NULL, stepscope_step_times(scenario, 0, 0, few, 2, NULL, NULL));
    STATUS(NULL, stepscope_run_edges(run, 0, NULL, &count));
    const stepscope_edge *edges = NULL;
    STATUS(NULL, stepscope_run_edges(run, 0, &edges, NULL));
    STATUS(NULL, stepscope_run_summary(run, 0, NULL));
    size_t index = 0;
    STATUS(NULL, stepscope_first_difference(NULL, 1, few, 1, 0, &index));
    STATUS(NULL, stepscope_first_difference(few, 1, NULL, 1, 0, &index));
    STATUS(NULL, stepscope_first_difference(few, 1, few, 1, 0, NULL));
    STATUS(RANGE, stepscope_first_difference(few, SIZE_MAX, few, 1, 0, &index));
    CHECK(index == STEPSCOPE_NONE);
}

/* A struct of another release: what it does not have is neither read nor written. */
static void sizes(void) {
    struct {
        stepscope_summary known;
        uint64_t later;
    } summary = {STEPSCOPE_SUMMARY, 77};
    summary.known.size = sizeof summary;
    STATUS(OK, stepscope_run_summary(run, 0, &summary.known));
    CHECK(summary.later == 77 && summary.known.size == sizeof summary && summary.known.positions[0] == 3200);
    summary.known.size = (uint32_t)sizeof(stepscope_summary) - 1;
    STATUS(RANGE, stepscope_run_summary(run, 0, &summary.known));
    STATUS(RANGE, stepscope_device_summary(device, &(stepscope_summary){0}));

    stepscope_run *made = run;
    stepscope_run_options options = STEPSCOPE_RUN_OPTIONS;
    options.size = 4;
    STATUS(RANGE, stepscope_run_scenario(scenario, &options, &made, NULL));
    CHECK(made == NULL);
    memset(&options, 0, sizeof options);
    options.size = sizeof options;
    memset(&options.keep_edges, 0xa5, 1); /* no bool of this language */
    STATUS(OK, stepscope_run_scenario(scenario, &options, &made, NULL));
    STATUS(OK, stepscope_run_free(made));
    options.keep_edges = false;
    STATUS(OK, stepscope_run_scenario(scenario, &options, &made, NULL));
    size_t count = 0;
    const stepscope_edge *edges = NULL;
    STATUS(ORDER, stepscope_run_edges(made, 0, &edges, &count));
    STATUS(ORDER, stepscope_run_steps(made, 0, 0, NULL, 0, &count));
    STATUS(ORDER, stepscope_run_write_vcd(made, 0, "misuse.vcd", NULL));
    STATUS(OK, stepscope_run_free(made));
}

static void again(void *context, stepscope_edge edge) {
    unsigned *busy = context;
    uint64_t levels = edge.levels;
    *busy += stepscope_device_clock(device, true, &levels) == STEPSCOPE_BUSY;
    *busy += stepscope_device_watch(device, NULL, NULL) == STEPSCOPE_BUSY;
    *busy += stepscope_device_free(device) == STEPSCOPE_BUSY;
}

static void devices(void) {
    uint64_t cycles = 0;
    uint32_t value = 0;
    unsigned busy = 0;
    STATUS(ORDER, stepscope_device_write(device, STEPSCOPE_REG_PUSH, 1));
    STATUS(RANGE, stepscope_device_advance(device, 1)); /* reset is an event */
    STATUS(OK, stepscope_device_watch(device, again, &busy));
    STATUS(OK, stepscope_device_clock(device, false, NULL));
    CHECK(busy == 3);
    STATUS(OK, stepscope_device_watch(device, NULL, NULL));
    STATUS(OK, stepscope_device_run_until(device, 5000, true));
    STATUS(RANGE, stepscope_device_run_until(device, 4999, true));
    STATUS(RANGE, stepscope_device_run_until(device, UINT64_MAX, true));
    STATUS(OK, stepscope_device_run_until(device, 5000, true));
    STATUS(RANGE, stepscope_device_advance(device, UINT64_MAX));
    STATUS(NULL, stepscope_device_cycles_until_event(device, NULL));
    STATUS(NULL, stepscope_device_read(device, 0, NULL));
    STATUS(NULL, stepscope_device_summary(device, NULL));
    STATUS(OK, stepscope_device_read(device, 0xfffffffe, &value));
    CHECK(value == 0);
    STATUS(OK, stepscope_device_write(device, 0xffffffff, 1));
    size_t count = 0;
    STATUS(NULL, stepscope_device_send(device, NULL, 1));
    STATUS(OK, stepscope_device_send(device, NULL, 0));
    STATUS(RANGE, stepscope_device_send(device, (const uint8_t *)"", SIZE_MAX));
    STATUS(RANGE, stepscope_device_receive(device, UINT64_MAX - 1, NULL, 0, &count));
    STATUS(NULL, stepscope_device_receive(device, 0, NULL, 0, NULL));
    STATUS(OK, stepscope_device_run_until(device, UINT64_C(9000000000000000), true));
    STATUS(RANGE, stepscope_device_clock(device, true, NULL));
    STATUS(OK, stepscope_device_cycles_until_event(device, &cycles));
}

static void frames(void) {
    uint8_t frame[608], body[600] = {0}, address = 0, kind = 0;
    size_t count = 0, length = 0;
    STATUS(RANGE, stepscope_encode_frame(1, 1, body, 595, frame, sizeof frame, &count));
    STATUS(OK, stepscope_encode_frame(1, 1, body, 594, frame, sizeof frame, &count));
    CHECK(count <= 604);
    STATUS(OK, stepscope_decode_frame(frame, count, &address, &kind, body, sizeof body, &length));
    CHECK(length == 594);
    STATUS(BUFFER, stepscope_decode_frame(frame, count, &address, &kind, body, 593, &length));
    STATUS(RANGE, stepscope_decode_frame(frame, count - 2, &address, &kind, body, sizeof body, &length));
    frame[9] ^= 1;
    STATUS(RANGE, stepscope_decode_frame(frame, count, &address, &kind, body, sizeof body, &length));
    STATUS(RANGE, stepscope_decode_frame(NULL, 0, &address, &kind, body, sizeof body, &length));
    STATUS(RANGE, stepscope_decode_frame((const uint8_t *)"\0\0", 2, &address, &kind, body, sizeof body, &length));
    STATUS(NULL, stepscope_decode_frame(NULL, 1, &address, &kind, body, sizeof body, &length));
    STATUS(OK, stepscope_encode_frame(1, 1, NULL, 0, frame, sizeof frame, &count));
    STATUS(NULL, stepscope_decode_frame(frame, count, NULL, &kind, body, sizeof body, &length));
    STATUS(NULL, stepscope_decode_frame(frame, count, &address, NULL, body, sizeof body, &length));
    STATUS(NULL, stepscope_encode_frame(1, 1, NULL, 1, frame, sizeof frame, &count));
}

int main(void) {
    make();
    handles();
    used_up_handles();
    texts();
    numbers();
    buffers();
    sizes();
    devices();
    frames();
    STATUS(OK, stepscope_scenario_free(scenario));
    STATUS(OK, stepscope_run_free(run));
    STATUS(OK, stepscope_device_free(device));
    STATUS(OK, stepscope_error_free(error));
    CHECK(stepscope_live() == 0);
    puts("each misuse has its status");
    return 0;
}
