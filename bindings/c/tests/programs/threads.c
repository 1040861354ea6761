/* Many threads read one scenario and one run; of one device a second call is BUSY, and nothing is lost. */
#include <pthread.h>
#include <stepscope.h>

#include "check.h"

enum { THREADS = 4, CALLS = 2000 };

static stepscope_scenario *scenario;
static stepscope_run *run;
static stepscope_device *device;
static pthread_barrier_t start;

typedef struct {
    unsigned ok, busy;
} Counts;

static void *work(void *context) {
    Counts *counts = context;
    stepscope_run *own = NULL;
    stepscope_summary shared = STEPSCOPE_SUMMARY, made = STEPSCOPE_SUMMARY;
    pthread_barrier_wait(&start);
    CHECK(stepscope_run_scenario(scenario, NULL, &own, NULL) == STEPSCOPE_OK);
    CHECK(stepscope_run_summary(own, 0, &made) == STEPSCOPE_OK);
    CHECK(stepscope_run_summary(run, 0, &shared) == STEPSCOPE_OK && made.digest == shared.digest);
    CHECK(stepscope_run_free(own) == STEPSCOPE_OK);
    for (unsigned i = 0; i < CALLS; ++i) {
        const stepscope_status status = stepscope_device_clock(device, true, NULL);
        CHECK(status == STEPSCOPE_OK || status == STEPSCOPE_BUSY);
        counts->ok += status == STEPSCOPE_OK;
        counts->busy += status == STEPSCOPE_BUSY;
    }
    return NULL;
}

/* Two threads free one handle: one is OK, the other HANDLE. */
static void *release(void *context) {
    Counts *counts = context;
    pthread_barrier_wait(&start);
    counts->ok = stepscope_run_free(run) == STEPSCOPE_OK;
    return NULL;
}

static Counts all(void *(*function)(void *)) {
    pthread_t threads[THREADS];
    Counts counts[THREADS] = {{0, 0}}, sum = {0, 0};
    CHECK(pthread_barrier_init(&start, NULL, THREADS) == 0);
    for (unsigned i = 0; i < THREADS; ++i) {
        CHECK(pthread_create(&threads[i], NULL, function, &counts[i]) == 0);
    }
    for (unsigned i = 0; i < THREADS; ++i) {
        CHECK(pthread_join(threads[i], NULL) == 0);
        sum.ok += counts[i].ok;
        sum.busy += counts[i].busy;
    }
    CHECK(pthread_barrier_destroy(&start) == 0);
    return sum;
}

static void *second(void *context) {
    Counts *counts = context;
    counts->busy = stepscope_device_clock(device, true, NULL) == STEPSCOPE_BUSY;
    counts->busy += stepscope_device_free(device) == STEPSCOPE_BUSY;
    return NULL;
}

/* Another thread comes while the device is surely in use: in the middle of a call. */
static void on_edge(void *context, stepscope_edge edge) {
    pthread_t thread;
    (void)edge;
    CHECK(pthread_create(&thread, NULL, second, context) == 0 && pthread_join(thread, NULL) == 0);
}

int main(void) {
    Counts counts = {0, 0};
    CHECK(stepscope_scenario_from_json("{}", 2, &scenario, NULL) == STEPSCOPE_OK);
    CHECK(stepscope_run_scenario(scenario, NULL, &run, NULL) == STEPSCOPE_OK);
    CHECK(stepscope_device_new(scenario, 0, &device, NULL) == STEPSCOPE_OK);
    CHECK(stepscope_device_watch(device, on_edge, &counts) == STEPSCOPE_OK);
    CHECK(stepscope_device_clock(device, true, NULL) == STEPSCOPE_OK && counts.busy == 2);
    CHECK(stepscope_device_watch(device, NULL, NULL) == STEPSCOPE_OK);

    counts = all(work);
    stepscope_summary summary = STEPSCOPE_SUMMARY;
    CHECK(stepscope_device_summary(device, &summary) == STEPSCOPE_OK);
    CHECK(counts.ok + counts.busy == THREADS * CALLS && summary.cycles == 1 + (uint64_t)counts.ok);
    CHECK(all(release).ok == 1);
    CHECK(stepscope_device_free(device) == STEPSCOPE_OK && stepscope_scenario_free(scenario) == STEPSCOPE_OK);
    CHECK(stepscope_live() == 0);
    puts("threads share what may be shared");
    return 0;
}
