/* Stepscope for C: a stepper-motion laboratory with clock-cycle accuracy.
 *
 * A scenario (JSON) has a motion, a host, a serial line and controllers. A run of it has every edge of STEP, DIR, EN, RX, TX
 * and DE with its clock cycle. The same scenario gives the same edges, bit for bit, in Rust, on the command line, in the page
 * and here.
 *
 * Handles are names that the library looks up and never follows: one that was freed, never made, or is of another kind is
 * STEPSCOPE_HANDLE. Each has its own _free; NULL is OK there. Runs, devices and errors outlive their scenario.
 *
 * Errors. A call that fails creates an error where *error is NULL; the caller frees it. An existing error is kept, so that one
 * check after several calls is enough. `error` may be NULL. OK leaves *error alone. After a failure *out is NULL.
 *
 * Buffers are (out, capacity, count): at most `capacity` items are written, *count is how many there are, and
 * STEPSCOPE_BUFFER means that there are more. `out` NULL with capacity 0 is OK and returns the count.
 *
 * Structs that begin with `size` are initialized by a macro: stepscope_summary summary = STEPSCOPE_SUMMARY;
 *
 * Threads. Scenarios, runs and errors may be used by many threads at once; a device by one call at a time. Callbacks come in
 * the thread of the call. The library prints nothing, and touches neither signals nor the environment.
 *
 * Texts are UTF-8. Times are whole clock cycles; numbers of controllers, axes and channels count from 0.
 */

#ifndef STEPSCOPE_H
#define STEPSCOPE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define STEPSCOPE_VERSION "0.2.0"
#define STEPSCOPE_ABI 1U /* must equal stepscope_abi() */

#define STEPSCOPE_TO_ZERO SIZE_MAX /* a length: up to the closing 0 */
#define STEPSCOPE_NONE SIZE_MAX    /* an index: the lists agree */
#define STEPSCOPE_NEVER UINT64_MAX /* cycles: nothing can change any more */

/* Levels: bits of stepscope_edge.levels and of stepscope_device_clock(). */
#define STEPSCOPE_LEVEL_STEP(channel) (UINT64_C(1) << (channel))
#define STEPSCOPE_LEVEL_DIR(channel) (UINT64_C(1) << (16U + (channel)))
#define STEPSCOPE_LEVEL_EN (UINT64_C(1) << 32) /* high: windings powered */
#define STEPSCOPE_LEVEL_RX (UINT64_C(1) << 33) /* the line as the receiver samples it */
#define STEPSCOPE_LEVEL_TX (UINT64_C(1) << 34) /* the controller's reply */
#define STEPSCOPE_LEVEL_DE (UINT64_C(1) << 35) /* the transceiver's transmit enable */

/* Registers: byte offsets for stepscope_device_read() and stepscope_device_write(). The data sheet is datasheet.md. */
#define STEPSCOPE_REG_ID 0x000U
#define STEPSCOPE_REG_CONTROL 0x010U
#define STEPSCOPE_REG_RESULT 0x014U
#define STEPSCOPE_REG_STATUS 0x018U
#define STEPSCOPE_REG_FAULTS 0x01CU
#define STEPSCOPE_REG_TICKS_DONE 0x020U
#define STEPSCOPE_REG_ORDERS 0x060U
#define STEPSCOPE_REG_PUSH 0x070U
#define STEPSCOPE_REG_POSITION 0x080U

enum {
    STEPSCOPE_OK = 0,
    STEPSCOPE_PROBLEMS = 1, /* the scenario is refused; the error lists every problem */
    STEPSCOPE_NULL = 2,     /* a pointer that must not be NULL is NULL */
    STEPSCOPE_HANDLE = 3,   /* freed, never made, or of another kind */
    STEPSCOPE_RANGE = 4,    /* no such controller, axis, channel, preset or number */
    STEPSCOPE_BUFFER = 5,   /* the buffer is too small: filled as far as it goes, *count is the number needed */
    STEPSCOPE_UTF8 = 6,     /* the text is not UTF-8 */
    STEPSCOPE_BUSY = 7,     /* in use by another thread, or by a callback of this one */
    STEPSCOPE_ORDER = 8,    /* not now: the edges were not stored, the device has not run */
    STEPSCOPE_STOPPED = 9,  /* the progress callback stopped the run */
    STEPSCOPE_FILE = 10,    /* a file could not be read or written */
    STEPSCOPE_PANIC = 11    /* a bug in the library; the handle is unusable, the process is not */
};


// A controller alone, clocked by its caller. One call at a time: a second one, also from its own callback, is
// STEPSCOPE_BUSY.
typedef struct stepscope_device stepscope_device;

// Why a call failed. Any number of threads may read it.
typedef struct stepscope_error stepscope_error;

// A run that has ended. It never changes, and any number of threads may use it.
typedef struct stepscope_run stepscope_run;

// A scenario: a motion, a host, a serial line, controllers. It never changes, and any number of threads may use it.
typedef struct stepscope_scenario stepscope_scenario;

// Result of a call: a STEPSCOPE_ constant.
typedef int32_t stepscope_status;

// State of a controller at the end of a run, or of a device now; initialize with STEPSCOPE_SUMMARY.
typedef struct {
    // sizeof(stepscope_summary)
    uint32_t size;
    // Controllers of the run, 1 to 32; 1 for a device.
    uint32_t controllers;
    // Cycles per second.
    uint32_t clock_hz;
    // Channels in use, 1 to 16.
    uint32_t channels;
    // Cycles of the run; of a device, the next cycle.
    uint64_t cycles;
    // Number of edges.
    uint64_t records;
    // Digest of all edges; print it as 16 hexadecimal digits.
    uint64_t digest;
    // Ticks that have ended.
    uint32_t ticks_done;
    // Bits of the register FAULTS.
    uint32_t faults;
    // Position of each channel in steps since reset, right positive; unused channels have 0.
    int32_t positions[16];
} stepscope_summary;

// An edge: the levels of all signals from a cycle on, as STEPSCOPE_LEVEL_ bits.
typedef struct {
    // Cycles since reset.
    uint64_t cycle;
    // Levels from this cycle on.
    uint64_t levels;
} stepscope_edge;

// Receives each edge in the cycle in which it happens, in the thread of the call. It must return: no longjmp, no exception.
typedef void (*stepscope_on_edge)(void *context, stepscope_edge edge);

// Reports how many cycles a run has made: 0 at the start, then from time to time, and all of them at the end. false stops the run. It is
// called in the thread of the run, and must return: no longjmp, no exception.
typedef bool (*stepscope_progress)(void *context, uint64_t cycles);

// Options of a run; initialize with STEPSCOPE_RUN_OPTIONS.
typedef struct {
    // sizeof(stepscope_run_options)
    uint32_t size;
    // true: edges are stored, 16 bytes each, at most 48000000. false: only the summary; no limit.
    bool keep_edges;
    // NULL: none.
    stepscope_progress progress;
    // First argument of `progress`.
    void *context;
} stepscope_run_options;

// A step: the cycle in which STEP rises, and its direction.
typedef struct {
    // Cycles since reset (of a run), or from the start of the motion (of a plan).
    uint64_t cycle;
    // +1 right, -1 left.
    int32_t direction;
    // 0.
    uint32_t reserved;
} stepscope_step;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

// The version of the library, such as "0.2.0".
const char *stepscope_version(void);

// The version of the binary interface. It must equal STEPSCOPE_ABI of the header that the program was compiled with.
uint32_t stepscope_abi(void);

// Number of scenarios, runs, devices and errors that are not freed yet.
size_t stepscope_live(void);

// A device before cycle 0, with clock, bus and line of a controller of the scenario; its motion is not used. `scenario` NULL:
// the defaults. `controller` counts from 0.
//
// Returns STEPSCOPE_PROBLEMS (the scenario is refused), _RANGE (no such controller), _NULL, _HANDLE.
stepscope_status stepscope_device_new(const stepscope_scenario *scenario,
                                      uint32_t controller,
                                      stepscope_device **out,
                                      stepscope_error **error);

// Runs one cycle with the line at `line`, as others drive it; true is idle. In cycle 0, reset, the line counts as high.
// Writes the levels of all signals in this cycle; `levels` may be NULL.
//
// Returns STEPSCOPE_BUSY, _RANGE (the end of time, cycle 9*10^15), _NULL, _HANDLE.
stepscope_status stepscope_device_clock(stepscope_device *device,
                                        bool line,
                                        uint64_t *levels);

// Number of cycles without change while the line keeps its level; STEPSCOPE_NEVER if nothing can change any more.
//
// Returns STEPSCOPE_BUSY, _NULL, _HANDLE.
stepscope_status stepscope_device_cycles_until_event(const stepscope_device *device,
                                                     uint64_t *cycles);

// Skips `cycles` cycles without change.
//
// Returns STEPSCOPE_RANGE (more than stepscope_device_cycles_until_event(); nothing is done), _BUSY, _NULL, _HANDLE.
stepscope_status stepscope_device_advance(stepscope_device *device,
                                          uint64_t cycles);

// Runs until `cycle` is the next one, with the line at `line`; cycles without change are skipped.
//
// Returns STEPSCOPE_RANGE (the cycle is past, or above 9*10^15), _BUSY, _NULL, _HANDLE.
stepscope_status stepscope_device_run_until(stepscope_device *device, uint64_t cycle, bool line);

// Sends bytes to the device, back to back at the bit rate of the scenario's line, from the next cycle on (at least cycle 1).
// Runs to the end of the last stop bit.
//
// Returns STEPSCOPE_RANGE (more bytes than time), _BUSY, _NULL, _HANDLE.
stepscope_status stepscope_device_send(stepscope_device *device,
                                       const uint8_t *bytes,
                                       size_t length);

// The oldest reply that was not received yet, with its closing 0x00; 600 bytes hold any. Runs on with an idle line until DE
// falls. Where DE does not rise within `timeout_cycles`, `*count` is 0 and as many cycles have run; STEPSCOPE_NEVER waits
// until nothing can change any more. 1024 replies are kept; then the oldest are dropped.
//
// Returns STEPSCOPE_BUFFER (the reply is kept, for a larger buffer), _RANGE (the end of time), _BUSY, _NULL, _HANDLE.
// `out` NULL with capacity 0 returns only the count, and keeps the reply.
stepscope_status stepscope_device_receive(stepscope_device *device,
                                          uint64_t timeout_cycles,
                                          uint8_t *out,
                                          size_t capacity,
                                          size_t *count);

// Reads the register at a byte offset (STEPSCOPE_REG_) in the last cycle that was run, or as in reset. Where there is no
// register the value is 0.
//
// Returns STEPSCOPE_BUSY, _NULL, _HANDLE.
stepscope_status stepscope_device_read(const stepscope_device *device,
                                       uint32_t offset,
                                       uint32_t *value);

// Writes the register at a byte offset (STEPSCOPE_REG_) in the last cycle that was run, after everything else in it. Where there is
// no register, or a read-only one, nothing happens.
//
// Returns STEPSCOPE_ORDER (the device has not run), _BUSY, _NULL, _HANDLE.
stepscope_status stepscope_device_write(stepscope_device *device,
                                        uint32_t offset,
                                        uint32_t value);

// The summary of the device so far.
//
// Returns STEPSCOPE_RANGE (out->size), _BUSY, _NULL, _HANDLE.
stepscope_status stepscope_device_summary(const stepscope_device *device, stepscope_summary *out);

// Calls `on_edge` for each edge from now on; NULL stops it. `context` is its first argument. The call comes
// in the thread that clocks the device.
//
// Returns STEPSCOPE_BUSY, _NULL, _HANDLE.
stepscope_status stepscope_device_watch(stepscope_device *device, stepscope_on_edge on_edge, void *context);

// Frees a device. NULL is OK; a second time is STEPSCOPE_HANDLE; during a call of the device STEPSCOPE_BUSY.
stepscope_status stepscope_device_free(stepscope_device *device);

// Number of problems, 1 to 100; 0 for NULL and for a handle that is no error.
size_t stepscope_error_count(const stepscope_error *error);

// All problems, one line per problem: `path: what is wrong, and what to use instead`. The text lives as long as the error. It is ""
// for NULL and for a handle that is no error; never NULL.
const char *stepscope_error_text(const stepscope_error *error);

// Path of problem `index`, which counts from 0, such as "bus.slots"; "" if it is the whole scenario. NULL beyond the last.
// The text lives as long as the error.
const char *stepscope_error_path(const stepscope_error *error,
                                 size_t index);

// Message of problem `index`, such as "0 is out of range; use 1 to 127". NULL beyond the last. The text lives as long as
// the error.
const char *stepscope_error_message(const stepscope_error *error,
                                    size_t index);

// Frees an error, and with it its texts. NULL is OK; a second time is STEPSCOPE_HANDLE.
stepscope_status stepscope_error_free(stepscope_error *error);

// Encodes a frame for the line: CRC, COBS and the closing 0x00. `length` is at most 594 bytes, and 604 bytes hold any frame.
// `body` may be NULL if `length` is 0. `out` NULL with capacity 0 returns only the count.
//
// Returns STEPSCOPE_RANGE (the body is too long), _BUFFER, _NULL.
stepscope_status stepscope_encode_frame(uint8_t address,
                                        uint8_t kind,
                                        const uint8_t *body,
                                        size_t length,
                                        uint8_t *out,
                                        size_t capacity,
                                        size_t *count);

// Decodes one frame; its closing 0x00 may be missing. Writes address, kind, and the body, which has at most 594 bytes.
//
// Returns STEPSCOPE_RANGE (no frame: COBS or CRC are wrong, or there is more than one), _BUFFER (the body is longer; address
// and kind are written), _NULL.
stepscope_status stepscope_decode_frame(const uint8_t *data,
                                        size_t length,
                                        uint8_t *address,
                                        uint8_t *kind,
                                        uint8_t *out,
                                        size_t capacity,
                                        size_t *count);

// Runs a scenario from reset to its end. `options` NULL: edges are stored, no progress.
//
// Returns STEPSCOPE_PROBLEMS (the scenario is refused, has no end or too many edges), _STOPPED (by the callback), _RANGE
// (options.size), _NULL, _HANDLE.
stepscope_status stepscope_run_scenario(const stepscope_scenario *scenario,
                                        const stepscope_run_options *options,
                                        stepscope_run **out,
                                        stepscope_error **error);

// The summary of a controller. `controller` counts from 0.
//
// Returns STEPSCOPE_RANGE (no such controller, or out->size), _NULL, _HANDLE.
stepscope_status stepscope_run_summary(const stepscope_run *run, uint32_t controller, stepscope_summary *out);

// Every edge of a controller, without a copy: `*edges` is valid until the run is freed. The first is that of reset.
//
// Returns STEPSCOPE_ORDER (they were not stored), _RANGE (no such controller), _NULL, _HANDLE.
stepscope_status stepscope_run_edges(const stepscope_run *run,
                                     uint32_t controller,
                                     const stepscope_edge **edges,
                                     size_t *count);

// The steps of a channel, in cycles since reset. Writes at most `capacity` of them to `out`, and their number to `*count`.
// `out` NULL with capacity 0 returns only the count. `controller` and `channel` count from 0; unused channels have none.
//
// Returns STEPSCOPE_ORDER (edges were not stored), _RANGE (no such controller; channel above 15), _BUFFER (there are more
// than `capacity`), _NULL, _HANDLE.
stepscope_status stepscope_run_steps(const stepscope_run *run,
                                     uint32_t controller,
                                     uint32_t channel,
                                     stepscope_step *out,
                                     size_t capacity,
                                     size_t *count);

// Writes the signals of a controller as a Value Change Dump in ns, for GTKWave, Surfer and PulseView. `path` is UTF-8; a
// file that is there is replaced.
//
// Returns STEPSCOPE_FILE (it cannot be written; the error has the reason), _ORDER (edges were not stored), _RANGE (no such
// controller), _UTF8, _NULL, _HANDLE.
stepscope_status stepscope_run_write_vcd(const stepscope_run *run,
                                         uint32_t controller,
                                         const char *path,
                                         stepscope_error **error);

// Frees a run, and with it its edges. NULL is OK; a second time is STEPSCOPE_HANDLE.
stepscope_status stepscope_run_free(stepscope_run *run);

// Reads a scenario from JSON text of `length` bytes (STEPSCOPE_TO_ZERO: up to its closing 0). Every field has a default, so
// "{}" is a scenario. Numbers that break a rule are reported by the calls that use the scenario.
//
// Returns STEPSCOPE_PROBLEMS (not JSON, or a wrong name or type: the error lists all problems), _UTF8, _NULL, _RANGE.
stepscope_status stepscope_scenario_from_json(const char *json,
                                              size_t length,
                                              stepscope_scenario **out,
                                              stepscope_error **error);

// Reads a scenario from a JSON file. `path` is UTF-8.
//
// Returns as stepscope_scenario_from_json(), and STEPSCOPE_FILE (it cannot be read; the error has the reason).
stepscope_status stepscope_scenario_from_file(const char *path,
                                              stepscope_scenario **out,
                                              stepscope_error **error);

// The scenario of a preset, such as "song-2021-one-turn".
//
// Returns STEPSCOPE_RANGE (no such preset: the error lists all names), _UTF8, _NULL.
stepscope_status stepscope_scenario_from_preset(const char *name,
                                                stepscope_scenario **out,
                                                stepscope_error **error);

// Frees a scenario; its runs and devices live on. NULL is OK; a second time is STEPSCOPE_HANDLE.
stepscope_status stepscope_scenario_free(stepscope_scenario *scenario);

// What a status means, in a few words. Never NULL; the text lives as long as the program.
const char *stepscope_status_text(stepscope_status status);

// The steps of an axis as planned, in cycles of the scenario's clock from the start of the motion. Writes at most `capacity`
// of them to `out`, and their number, up to 24000000, to `*count`. `out` NULL with capacity 0 returns only the count.
// `controller` and `axis` count from 0.
//
// Returns STEPSCOPE_PROBLEMS (the scenario is refused, or is no motion), _RANGE (no such controller or axis),
// _BUFFER (there are more than `capacity`), _NULL, _HANDLE.
stepscope_status stepscope_step_times(const stepscope_scenario *scenario,
                                      uint32_t controller,
                                      uint32_t axis,
                                      stepscope_step *out,
                                      size_t capacity,
                                      size_t *count,
                                      stepscope_error **error);

// The first index at which two lists of steps differ: cycles more than `within_cycles` apart, another direction, or the end
// of one list. Writes STEPSCOPE_NONE if they agree; a difference of exactly `within_cycles` is none. A direction above 0 is
// right. A list without steps may be NULL.
//
// Returns STEPSCOPE_NULL, _RANGE (a list is longer than memory).
stepscope_status stepscope_first_difference(const stepscope_step *expected,
                                            size_t expected_count,
                                            const stepscope_step *found,
                                            size_t found_count,
                                            uint64_t within_cycles,
                                            size_t *index);

// What a status means, in a few words. Never NULL; the text lives as long as the program.
const char *stepscope_status_text(stepscope_status status);

// Number of problems, 1 to 100; 0 for NULL and for a handle that is no error.
size_t stepscope_error_count(const stepscope_error *error);

// All problems, one line per problem: `path: what is wrong, and what to use instead`. The text lives as long as the error. It is ""
// for NULL and for a handle that is no error; never NULL.
const char *stepscope_error_text(const stepscope_error *error);

// Path of problem `index`, which counts from 0, such as "bus.slots"; "" if it is the whole scenario. NULL beyond the last.
// The text lives as long as the error.
const char *stepscope_error_path(const stepscope_error *error,
                                 size_t index);

// Message of problem `index`, such as "0 is out of range; use 1 to 127". NULL beyond the last. The text lives as long as
// the error.
const char *stepscope_error_message(const stepscope_error *error,
                                    size_t index);

// Frees an error, and with it its texts. NULL is OK; a second time is STEPSCOPE_HANDLE.
stepscope_status stepscope_error_free(stepscope_error *error);

// Reads a scenario from JSON text of `length` bytes (STEPSCOPE_TO_ZERO: up to its closing 0). Every field has a default, so
// "{}" is a scenario. Numbers that break a rule are reported by the calls that use the scenario.
//
// Returns STEPSCOPE_PROBLEMS (not JSON, or a wrong name or type: the error lists all problems), _UTF8, _NULL, _RANGE.
stepscope_status stepscope_scenario_from_json(const char *json,
                                              size_t length,
                                              stepscope_scenario **out,
                                              stepscope_error **error);

// Reads a scenario from a JSON file. `path` is UTF-8.
//
// Returns as stepscope_scenario_from_json(), and STEPSCOPE_FILE (it cannot be read; the error has the reason).
stepscope_status stepscope_scenario_from_file(const char *path,
                                              stepscope_scenario **out,
                                              stepscope_error **error);

// The scenario of a preset, such as "song-2021-one-turn".
//
// Returns STEPSCOPE_RANGE (no such preset: the error lists all names), _UTF8, _NULL.
stepscope_status stepscope_scenario_from_preset(const char *name,
                                                stepscope_scenario **out,
                                                stepscope_error **error);

// Frees a scenario; its runs and devices live on. NULL is OK; a second time is STEPSCOPE_HANDLE.
stepscope_status stepscope_scenario_free(stepscope_scenario *scenario);

// Runs a scenario from reset to its end. `options` NULL: edges are stored, no progress.
//
// Returns STEPSCOPE_PROBLEMS (the scenario is refused, has no end or too many edges), _STOPPED (by the callback), _RANGE
// (options.size), _NULL, _HANDLE.
stepscope_status stepscope_run_scenario(const stepscope_scenario *scenario,
                                        const stepscope_run_options *options,
                                        stepscope_run **out,
                                        stepscope_error **error);

// The summary of a controller. `controller` counts from 0.
//
// Returns STEPSCOPE_RANGE (no such controller, or out->size), _NULL, _HANDLE.
stepscope_status stepscope_run_summary(const stepscope_run *run, uint32_t controller, stepscope_summary *out);

// Every edge of a controller, without a copy: `*edges` is valid until the run is freed. The first is that of reset.
//
// Returns STEPSCOPE_ORDER (they were not stored), _RANGE (no such controller), _NULL, _HANDLE.
stepscope_status stepscope_run_edges(const stepscope_run *run,
                                     uint32_t controller,
                                     const stepscope_edge **edges,
                                     size_t *count);

// The steps of a channel, in cycles since reset. Writes at most `capacity` of them to `out`, and their number to `*count`.
// `out` NULL with capacity 0 returns only the count. `controller` and `channel` count from 0; unused channels have none.
//
// Returns STEPSCOPE_ORDER (edges were not stored), _RANGE (no such controller; channel above 15), _BUFFER (there are more
// than `capacity`), _NULL, _HANDLE.
stepscope_status stepscope_run_steps(const stepscope_run *run,
                                     uint32_t controller,
                                     uint32_t channel,
                                     stepscope_step *out,
                                     size_t capacity,
                                     size_t *count);

// Writes the signals of a controller as a Value Change Dump in ns, for GTKWave, Surfer and PulseView. `path` is UTF-8; a
// file that is there is replaced.
//
// Returns STEPSCOPE_FILE (it cannot be written; the error has the reason), _ORDER (edges were not stored), _RANGE (no such
// controller), _UTF8, _NULL, _HANDLE.
stepscope_status stepscope_run_write_vcd(const stepscope_run *run,
                                         uint32_t controller,
                                         const char *path,
                                         stepscope_error **error);

// Frees a run, and with it its edges. NULL is OK; a second time is STEPSCOPE_HANDLE.
stepscope_status stepscope_run_free(stepscope_run *run);

// The steps of an axis as planned, in cycles of the scenario's clock from the start of the motion. Writes at most `capacity`
// of them to `out`, and their number, up to 24000000, to `*count`. `out` NULL with capacity 0 returns only the count.
// `controller` and `axis` count from 0.
//
// Returns STEPSCOPE_PROBLEMS (the scenario is refused, or is no motion), _RANGE (no such controller or axis),
// _BUFFER (there are more than `capacity`), _NULL, _HANDLE.
stepscope_status stepscope_step_times(const stepscope_scenario *scenario,
                                      uint32_t controller,
                                      uint32_t axis,
                                      stepscope_step *out,
                                      size_t capacity,
                                      size_t *count,
                                      stepscope_error **error);

// The first index at which two lists of steps differ: cycles more than `within_cycles` apart, another direction, or the end
// of one list. Writes STEPSCOPE_NONE if they agree; a difference of exactly `within_cycles` is none. A direction above 0 is
// right. A list without steps may be NULL.
//
// Returns STEPSCOPE_NULL, _RANGE (a list is longer than memory).
stepscope_status stepscope_first_difference(const stepscope_step *expected,
                                            size_t expected_count,
                                            const stepscope_step *found,
                                            size_t found_count,
                                            uint64_t within_cycles,
                                            size_t *index);

// A device before cycle 0, with clock, bus and line of a controller of the scenario; its motion is not used. `scenario` NULL:
// the defaults. `controller` counts from 0.
//
// Returns STEPSCOPE_PROBLEMS (the scenario is refused), _RANGE (no such controller), _NULL, _HANDLE.
stepscope_status stepscope_device_new(const stepscope_scenario *scenario,
                                      uint32_t controller,
                                      stepscope_device **out,
                                      stepscope_error **error);

// Runs one cycle with the line at `line`, as others drive it; true is idle. In cycle 0, reset, the line counts as high.
// Writes the levels of all signals in this cycle; `levels` may be NULL.
//
// Returns STEPSCOPE_BUSY, _RANGE (the end of time, cycle 9*10^15), _NULL, _HANDLE.
stepscope_status stepscope_device_clock(stepscope_device *device,
                                        bool line,
                                        uint64_t *levels);

// Number of cycles without change while the line keeps its level; STEPSCOPE_NEVER if nothing can change any more.
//
// Returns STEPSCOPE_BUSY, _NULL, _HANDLE.
stepscope_status stepscope_device_cycles_until_event(const stepscope_device *device,
                                                     uint64_t *cycles);

// Skips `cycles` cycles without change.
//
// Returns STEPSCOPE_RANGE (more than stepscope_device_cycles_until_event(); nothing is done), _BUSY, _NULL, _HANDLE.
stepscope_status stepscope_device_advance(stepscope_device *device,
                                          uint64_t cycles);

// Runs until `cycle` is the next one, with the line at `line`; cycles without change are skipped.
//
// Returns STEPSCOPE_RANGE (the cycle is past, or above 9*10^15), _BUSY, _NULL, _HANDLE.
stepscope_status stepscope_device_run_until(stepscope_device *device, uint64_t cycle, bool line);

// Sends bytes to the device, back to back at the bit rate of the scenario's line, from the next cycle on (at least cycle 1).
// Runs to the end of the last stop bit.
//
// Returns STEPSCOPE_RANGE (more bytes than time), _BUSY, _NULL, _HANDLE.
stepscope_status stepscope_device_send(stepscope_device *device,
                                       const uint8_t *bytes,
                                       size_t length);

// The oldest reply that was not received yet, with its closing 0x00; 600 bytes hold any. Runs on with an idle line until DE
// falls. Where DE does not rise within `timeout_cycles`, `*count` is 0 and as many cycles have run; STEPSCOPE_NEVER waits
// until nothing can change any more. 1024 replies are kept; then the oldest are dropped.
//
// Returns STEPSCOPE_BUFFER (the reply is kept, for a larger buffer), _RANGE (the end of time), _BUSY, _NULL, _HANDLE.
// `out` NULL with capacity 0 returns only the count, and keeps the reply.
stepscope_status stepscope_device_receive(stepscope_device *device,
                                          uint64_t timeout_cycles,
                                          uint8_t *out,
                                          size_t capacity,
                                          size_t *count);

// Reads the register at a byte offset (STEPSCOPE_REG_) in the last cycle that was run, or as in reset. Where there is no
// register the value is 0.
//
// Returns STEPSCOPE_BUSY, _NULL, _HANDLE.
stepscope_status stepscope_device_read(const stepscope_device *device,
                                       uint32_t offset,
                                       uint32_t *value);

// Writes the register at a byte offset (STEPSCOPE_REG_) in the last cycle that was run, after everything else in it. Where there is
// no register, or a read-only one, nothing happens.
//
// Returns STEPSCOPE_ORDER (the device has not run), _BUSY, _NULL, _HANDLE.
stepscope_status stepscope_device_write(stepscope_device *device,
                                        uint32_t offset,
                                        uint32_t value);

// The summary of the device so far.
//
// Returns STEPSCOPE_RANGE (out->size), _BUSY, _NULL, _HANDLE.
stepscope_status stepscope_device_summary(const stepscope_device *device, stepscope_summary *out);

// Calls `on_edge` for each edge from now on; NULL stops it. `context` is its first argument. The call comes
// in the thread that clocks the device.
//
// Returns STEPSCOPE_BUSY, _NULL, _HANDLE.
stepscope_status stepscope_device_watch(stepscope_device *device, stepscope_on_edge on_edge, void *context);

// Frees a device. NULL is OK; a second time is STEPSCOPE_HANDLE; during a call of the device STEPSCOPE_BUSY.
stepscope_status stepscope_device_free(stepscope_device *device);

// Encodes a frame for the line: CRC, COBS and the closing 0x00. `length` is at most 594 bytes, and 604 bytes hold any frame.
// `body` may be NULL if `length` is 0. `out` NULL with capacity 0 returns only the count.
//
// Returns STEPSCOPE_RANGE (the body is too long), _BUFFER, _NULL.
stepscope_status stepscope_encode_frame(uint8_t address,
                                        uint8_t kind,
                                        const uint8_t *body,
                                        size_t length,
                                        uint8_t *out,
                                        size_t capacity,
                                        size_t *count);

// Decodes one frame; its closing 0x00 may be missing. Writes address, kind, and the body, which has at most 594 bytes.
//
// Returns STEPSCOPE_RANGE (no frame: COBS or CRC are wrong, or there is more than one), _BUFFER (the body is longer; address
// and kind are written), _NULL.
stepscope_status stepscope_decode_frame(const uint8_t *data,
                                        size_t length,
                                        uint8_t *address,
                                        uint8_t *kind,
                                        uint8_t *out,
                                        size_t capacity,
                                        size_t *count);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* STEPSCOPE_H */

#define STEPSCOPE_RUN_OPTIONS {sizeof(stepscope_run_options), true, NULL, NULL}
#define STEPSCOPE_SUMMARY {sizeof(stepscope_summary), 0, 0, 0, 0, 0, 0, 0, 0, {0}}
