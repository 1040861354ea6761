/* The published interface, declared a second time: a function, type or constant that changes does not compile. */
#include <stepscope.h>

#define ASSERT(condition) _Static_assert(condition, #condition)

const char *stepscope_version(void);
uint32_t stepscope_abi(void);
const char *stepscope_status_text(stepscope_status status);
size_t stepscope_live(void);

size_t stepscope_error_count(const stepscope_error *error);
const char *stepscope_error_text(const stepscope_error *error);
const char *stepscope_error_path(const stepscope_error *error, size_t index);
const char *stepscope_error_message(const stepscope_error *error, size_t index);
stepscope_status stepscope_error_free(stepscope_error *error);

stepscope_status stepscope_scenario_from_json(const char *json, size_t length, stepscope_scenario **out,
                                              stepscope_error **error);
stepscope_status stepscope_scenario_from_file(const char *path, stepscope_scenario **out, stepscope_error **error);
stepscope_status stepscope_scenario_from_preset(const char *name, stepscope_scenario **out, stepscope_error **error);
stepscope_status stepscope_scenario_free(stepscope_scenario *scenario);

stepscope_status stepscope_run_scenario(const stepscope_scenario *scenario, const stepscope_run_options *options,
                                        stepscope_run **out, stepscope_error **error);
stepscope_status stepscope_run_summary(const stepscope_run *run, uint32_t controller, stepscope_summary *out);
stepscope_status stepscope_run_edges(const stepscope_run *run, uint32_t controller, const stepscope_edge **edges,
                                     size_t *count);
stepscope_status stepscope_run_steps(const stepscope_run *run, uint32_t controller, uint32_t channel,
                                     stepscope_step *out, size_t capacity, size_t *count);
stepscope_status stepscope_run_write_vcd(const stepscope_run *run, uint32_t controller, const char *path,
                                         stepscope_error **error);
stepscope_status stepscope_run_free(stepscope_run *run);

stepscope_status stepscope_step_times(const stepscope_scenario *scenario, uint32_t controller, uint32_t axis,
                                      stepscope_step *out, size_t capacity, size_t *count, stepscope_error **error);
stepscope_status stepscope_first_difference(const stepscope_step *expected, size_t expected_count,
                                            const stepscope_step *found, size_t found_count, uint64_t within_cycles,
                                            size_t *index);

stepscope_status stepscope_device_new(const stepscope_scenario *scenario, uint32_t controller, stepscope_device **out,
                                      stepscope_error **error);
stepscope_status stepscope_device_clock(stepscope_device *device, bool line, uint64_t *levels);
stepscope_status stepscope_device_cycles_until_event(const stepscope_device *device, uint64_t *cycles);
stepscope_status stepscope_device_advance(stepscope_device *device, uint64_t cycles);
stepscope_status stepscope_device_run_until(stepscope_device *device, uint64_t cycle, bool line);
stepscope_status stepscope_device_send(stepscope_device *device, const uint8_t *bytes, size_t length);
stepscope_status stepscope_device_receive(stepscope_device *device, uint64_t timeout_cycles, uint8_t *out,
                                          size_t capacity, size_t *count);
stepscope_status stepscope_device_read(const stepscope_device *device, uint32_t offset, uint32_t *value);
stepscope_status stepscope_device_write(stepscope_device *device, uint32_t offset, uint32_t value);
stepscope_status stepscope_device_summary(const stepscope_device *device, stepscope_summary *out);
stepscope_status stepscope_device_watch(stepscope_device *device, stepscope_on_edge on_edge, void *context);
stepscope_status stepscope_device_free(stepscope_device *device);

stepscope_status stepscope_encode_frame(uint8_t address, uint8_t kind, const uint8_t *body, size_t length,
                                        uint8_t *out, size_t capacity, size_t *count);
stepscope_status stepscope_decode_frame(const uint8_t *data, size_t length, uint8_t *address, uint8_t *kind,
                                        uint8_t *out, size_t capacity, size_t *count);

ASSERT(sizeof(stepscope_status) == 4);
ASSERT(STEPSCOPE_OK == 0 && STEPSCOPE_PROBLEMS == 1 && STEPSCOPE_NULL == 2 && STEPSCOPE_HANDLE == 3);
ASSERT(STEPSCOPE_RANGE == 4 && STEPSCOPE_BUFFER == 5 && STEPSCOPE_UTF8 == 6 && STEPSCOPE_BUSY == 7);
ASSERT(STEPSCOPE_ORDER == 8 && STEPSCOPE_STOPPED == 9 && STEPSCOPE_FILE == 10 && STEPSCOPE_PANIC == 11);
ASSERT(STEPSCOPE_ABI == 1U);

ASSERT(sizeof(stepscope_edge) == 16 && offsetof(stepscope_edge, levels) == 8);
ASSERT(sizeof(stepscope_step) == 16 && offsetof(stepscope_step, direction) == 8);
ASSERT(offsetof(stepscope_run_options, size) == 0 && offsetof(stepscope_run_options, keep_edges) == 4);
ASSERT(offsetof(stepscope_run_options, progress) == 8);
ASSERT(offsetof(stepscope_run_options, context) == 8 + sizeof(void *));
ASSERT(offsetof(stepscope_summary, size) == 0 && offsetof(stepscope_summary, controllers) == 4);
ASSERT(offsetof(stepscope_summary, clock_hz) == 8 && offsetof(stepscope_summary, channels) == 12);
ASSERT(offsetof(stepscope_summary, cycles) == 16 && offsetof(stepscope_summary, records) == 24);
ASSERT(offsetof(stepscope_summary, digest) == 32 && offsetof(stepscope_summary, ticks_done) == 40);
ASSERT(offsetof(stepscope_summary, faults) == 44 && offsetof(stepscope_summary, positions) == 48);
ASSERT(sizeof(stepscope_summary) == 112);
ASSERT(STEPSCOPE_LEVEL_STEP(15) == UINT64_C(0x8000) && STEPSCOPE_LEVEL_DIR(0) == UINT64_C(0x10000));

static bool on_progress(void *context, uint64_t cycles) { return context == NULL || cycles == 0U; }
static void on_edge(void *context, stepscope_edge edge) { (void)context, (void)edge; }

int main(void) {
    const stepscope_progress progress = on_progress;
    const stepscope_on_edge watch = on_edge;
    const stepscope_run_options options = STEPSCOPE_RUN_OPTIONS;
    const stepscope_summary summary = STEPSCOPE_SUMMARY;
    watch(NULL, (stepscope_edge){0U, 0U});
    return progress(NULL, 1U) && options.keep_edges && options.size == sizeof options &&
                   summary.size == sizeof summary && stepscope_abi() == STEPSCOPE_ABI
               ? 0
               : 1;
}
