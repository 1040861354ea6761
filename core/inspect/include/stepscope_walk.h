/* stepscope_walk.h: walks the step tables of `stepscope tables --format c` and `--format avr`.
 *
 * Put this file next to the tables. C99, C++11 and avr-gcc 5.4; no heap, no floats, no loops. A call reads at most one
 * entry and changes only its walk, so separate walks may interrupt each other. For a table named turn:
 *
 *   turn_walk walk;                             turn_begin(&walk) begins at time 0, direction left
 *   uint8_t event = turn_next(&walk, &cycles);  the next event, `cycles` after the previous one
 *
 *   STEPSCOPE_STEP  a step, to the right if walk.right is 1, else to the left
 *   STEPSCOPE_WAIT  no step; afterwards walk.right may have changed
 *   STEPSCOPE_END   no more events; cycles is 0
 *
 * Fractions of a cycle are carried, so times are those of the table, rounded down. A change of direction is a WAIT of
 * 0 cycles: call turn_next again immediately. A table without steps is one WAIT of 0 cycles. All other events take
 * TURN_MIN_CYCLES to TURN_MAX_CYCLES. An interval that is too long for an entry is divided evenly into waits.
 * A sample interrupt, for Timer1 of an AVR without prescaler and TURN_MAX_CYCLES below 65536:
 *
 *   static turn_walk walk;
 *   static uint8_t event = STEPSCOPE_WAIT;      enable the interrupt after turn_begin(&walk) and OCR1A = TCNT1 + 1000
 *
 *   ISR(TIMER1_COMPA_vect)
 *   {
 *       uint32_t cycles;
 *       if (event == STEPSCOPE_STEP) { PORTB |= STEP; }
 *       event = turn_next(&walk, &cycles);
 *       if ((event == STEPSCOPE_WAIT) && (cycles == 0U)) { event = turn_next(&walk, &cycles); }
 *       if (event == STEPSCOPE_END) { TIMSK1 = 0; }
 *       OCR1A += (uint16_t)cycles;
 *       PORTB &= ~STEP;
 *       if (walk.right) { PORTB |= DIR; } else { PORTB &= ~DIR; }
 *   }
 *
 * MISRA C:2012: cppcheck's add-on reports rules 2.3, 2.5, 8.9 and 20.7 here and in a table. They are deviations, as are
 * directive 4.9 and rule 20.10. STEPSCOPE_TABLE forms a type and two functions from a table's name, so its parameters
 * are operands of ## without parentheses. Only these functions use the array, and no file uses all types and macros.
 */
#ifndef STEPSCOPE_WALK_H
#define STEPSCOPE_WALK_H

#include <stddef.h>
#include <stdint.h>

#if defined(__AVR__)
#include <avr/pgmspace.h>
#elif !defined(PROGMEM)
#define PROGMEM /* tables for an AVR compile elsewhere, too: for tests of a firmware */
#endif

#define STEPSCOPE_END 0U
#define STEPSCOPE_STEP 1U
#define STEPSCOPE_WAIT 2U

/* `count` steps, the first one `interval` after the previous event; the interval then changes by `add` per step. If
 * count is 0, a wait of `interval`; `add` is the direction after it: 1 right, 0 left. */
typedef struct {
    uint32_t interval; /* cycles */
    uint16_t count;
    int16_t add;
} stepscope_ticks_entry;

/* The same with interval and add in 1/256 cycle */
typedef stepscope_ticks_entry stepscope_q8_entry;

/* The same with interval and add in 1/65536 cycle */
typedef struct {
    uint64_t interval;
    uint32_t count;
    int64_t add;
} stepscope_q16_entry;

typedef struct {
    size_t at;         /* next entry */
    uint32_t interval; /* of the next step or wait */
    uint16_t count;    /* steps left of the entry before `at` */
    int16_t add;
    uint8_t waits;    /* 1 before the event of a wait */
    uint8_t fraction; /* carried, in 1/256 cycle */
    uint8_t right;    /* direction: 1 right, 0 left */
} stepscope_ticks_walk;

typedef stepscope_ticks_walk stepscope_q8_walk;

typedef struct {
    size_t at;
    uint64_t interval;
    uint32_t count;
    int64_t add;
    uint16_t fraction; /* in 1/65536 cycle */
    uint8_t waits;
    uint8_t right;
} stepscope_q16_walk;

/* Cycles of an event */
typedef uint32_t stepscope_ticks_time;
typedef uint32_t stepscope_q8_time;
typedef uint64_t stepscope_q16_time;

static inline void stepscope_ticks_take(stepscope_ticks_walk *w, stepscope_ticks_entry entry)
{
    w->at++;
    w->interval = entry.interval;
    w->count = entry.count;
    w->add = entry.add;
    w->waits = (entry.count == 0U) ? 1U : 0U;
}

static inline void stepscope_q16_take(stepscope_q16_walk *w, stepscope_q16_entry entry)
{
    w->at++;
    w->interval = entry.interval;
    w->count = entry.count;
    w->add = entry.add;
    w->waits = (entry.count == 0U) ? 1U : 0U;
}

/* The event of the loaded entry, and its time in units of the table */
static inline uint8_t stepscope_ticks_event(stepscope_ticks_walk *w, uint32_t *units)
{
    uint8_t event = STEPSCOPE_END;
    *units = 0U;
    if (w->count != 0U) {
        const int32_t add = w->add;
        event = STEPSCOPE_STEP;
        *units = w->interval;
        w->interval = w->interval + (uint32_t)add; /* wraps only after an entry's last step */
        w->count--;
    } else if (w->waits != 0U) {
        event = STEPSCOPE_WAIT;
        *units = w->interval;
        w->right = (w->add != 0) ? 1U : 0U;
        w->waits = 0U;
    } else {
        /* the end of the table */
    }
    return event;
}

static inline uint8_t stepscope_q8_event(stepscope_q8_walk *w, uint32_t *cycles)
{
    uint32_t units;
    const uint8_t event = stepscope_ticks_event(w, &units);
    const uint32_t part = (units & 0xFFU) + w->fraction;
    *cycles = (units >> 8) + (part >> 8);
    w->fraction = (uint8_t)(part & 0xFFU);
    return event;
}

static inline uint8_t stepscope_q16_event(stepscope_q16_walk *w, uint64_t *cycles)
{
    uint8_t event = STEPSCOPE_END;
    uint64_t units = 0U;
    if (w->count != 0U) {
        event = STEPSCOPE_STEP;
        units = w->interval;
        w->interval = w->interval + (uint64_t)w->add;
        w->count--;
    } else if (w->waits != 0U) {
        event = STEPSCOPE_WAIT;
        units = w->interval;
        w->right = (w->add != 0) ? 1U : 0U;
        w->waits = 0U;
    } else {
        /* the end of the table */
    }
    const uint64_t part = (units & 0xFFFFU) + w->fraction;
    *cycles = (units >> 16) + (part >> 16);
    w->fraction = (uint16_t)(part & 0xFFFFU);
    return event;
}

/* Reads an entry into the walk */
static inline void stepscope_ticks_read(stepscope_ticks_walk *w, const stepscope_ticks_entry *from)
{
    stepscope_ticks_take(w, *from);
}

static inline void stepscope_q8_read(stepscope_q8_walk *w, const stepscope_q8_entry *from)
{
    stepscope_ticks_take(w, *from);
}

static inline void stepscope_q16_read(stepscope_q16_walk *w, const stepscope_q16_entry *from)
{
    stepscope_q16_take(w, *from);
}

#if defined(__AVR__)
static inline void stepscope_ticks_read_p(stepscope_ticks_walk *w, const stepscope_ticks_entry *from)
{
    stepscope_ticks_entry entry;
    entry.interval = pgm_read_dword(&from->interval);
    entry.count = pgm_read_word(&from->count);
    entry.add = (int16_t)pgm_read_word(&from->add);
    stepscope_ticks_take(w, entry);
}

static inline void stepscope_q8_read_p(stepscope_q8_walk *w, const stepscope_q8_entry *from)
{
    stepscope_ticks_read_p(w, from);
}

static inline uint64_t stepscope_qword_p(const uint8_t *from)
{
    const uint64_t low = pgm_read_dword(from);
    const uint64_t high = pgm_read_dword(&from[4]);
    return (high << 32) | low;
}

static inline void stepscope_q16_read_p(stepscope_q16_walk *w, const stepscope_q16_entry *from)
{
    stepscope_q16_entry entry;
    entry.interval = stepscope_qword_p((const uint8_t *)&from->interval);
    entry.count = pgm_read_dword(&from->count);
    entry.add = (int64_t)stepscope_qword_p((const uint8_t *)&from->add);
    stepscope_q16_take(w, entry);
}
#endif

/* Defines NAME_walk, NAME_begin() and NAME_next() for NAME_entries. The second pointer avoids a false report of
 * cppcheck, which cannot tell the two functions of one line apart: use of a walk before its begin. */
#define STEPSCOPE_TABLE(name, kind, read)                                              \
    typedef stepscope_##kind##_walk name##_walk;                                       \
    static inline void name##_begin(name##_walk *w)                                    \
    {                                                                                  \
        w->at = 0U;                                                                    \
        w->interval = 0U;                                                              \
        w->count = 0U;                                                                 \
        w->add = 0;                                                                    \
        w->fraction = 0U;                                                              \
        w->waits = 0U;                                                                 \
        w->right = 0U;                                                                 \
    }                                                                                  \
    static inline uint8_t name##_next(name##_walk *w, stepscope_##kind##_time *cycles) \
    {                                                                                  \
        const size_t length = sizeof(name##_entries) / sizeof(name##_entries[0]);      \
        name##_walk *const walk = w;                                                   \
        if ((walk->count == 0U) && (walk->at < length)) {                              \
            stepscope_##kind##_##read(walk, &name##_entries[walk->at]);                \
        }                                                                              \
        return stepscope_##kind##_event(walk, cycles);                                 \
    }

#define STEPSCOPE_TICKS_TABLE(name) STEPSCOPE_TABLE(name, ticks, read)
#define STEPSCOPE_Q8_TABLE(name) STEPSCOPE_TABLE(name, q8, read)
#define STEPSCOPE_Q16_TABLE(name) STEPSCOPE_TABLE(name, q16, read)

/* The same for tables in program memory */
#if defined(__AVR__)
#define STEPSCOPE_TICKS_TABLE_P(name) STEPSCOPE_TABLE(name, ticks, read_p)
#define STEPSCOPE_Q8_TABLE_P(name) STEPSCOPE_TABLE(name, q8, read_p)
#define STEPSCOPE_Q16_TABLE_P(name) STEPSCOPE_TABLE(name, q16, read_p)
#else
#define STEPSCOPE_TICKS_TABLE_P(name) STEPSCOPE_TICKS_TABLE(name)
#define STEPSCOPE_Q8_TABLE_P(name) STEPSCOPE_Q8_TABLE(name)
#define STEPSCOPE_Q16_TABLE_P(name) STEPSCOPE_Q16_TABLE(name)
#endif

#endif
