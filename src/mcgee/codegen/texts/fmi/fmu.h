/* What the FMUs of both versions share: an instance, its copies, and which call may be made when.
 *
 * An instance holds numbers and whom it tells of errors, and no memory of its own. A call that is
 * refused changes nothing. fmi2.c and fmi3.c say before this what FMI(...) and a Listener are. */

#ifndef FMU_H
#define FMU_H

#include <math.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef FMI(Status) Status;
typedef FMI(ValueReference) Reference;

/* Where the variables are; their value references say the same. */
enum {
    TIME,
    TAU,
    Q = TAU + JOINTS,
    QD = Q + JOINTS,
    PARAMETER = QD + JOINTS,
    MAX_STEP = PARAMETER + PARAMETERS,
    CALCULATED, /* from here on */
    DER_Q = CALCULATED,
    QDD = DER_Q + JOINTS,
    KINETIC = QDD + JOINTS,
    POTENTIAL,
    TOTAL,
    VARIABLES,
    STATES = 2*JOINTS
};

typedef char params_are_doubles[sizeof(Params) == PARAMETERS*sizeof(double) ? 1 : -1];

enum { MODEL_EXCHANGE, CO_SIMULATION, CO_SIMULATION_WITH_EVENTS };

enum {
    INSTANTIATED = 1,
    INITIALIZATION = 2,
    EVENT = 4,
    CONTINUOUS = 8,
    STEP_EVENT = 16, /* the event mode of co-simulation */
    STEP = 32,
    TERMINATED = 64,
    CALCULABLE = INITIALIZATION | EVENT | CONTINUOUS | TERMINATED,
    ANY = 127
};

enum { TELL_ERRORS = 1, TELL_DISCARDS = 2, TELL_ALL = 3 };

/* All that a simulation depends on, without padding. */
typedef struct {
    double value[VARIABLES];
    char token[44];
    int32_t kind, mode, stale; /* stale: what is calculated is not of these values */
} State;

typedef struct {
    State now;
    Listener listener;
    unsigned told;
    const char *function; /* that is being called */
    int discarded;        /* whether the last step was */
} Instance;

static void report(const Instance *m, Status status, const char *category, const char *text);

/* The status, with its reason told. */
static Status refused(const Instance *m, Status status, const char *format, ...)
{
    const int error = status == FMI(Error);
    char text[256];
    const int head = snprintf(text, sizeof text, "%s: ", m->function);
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text + head, sizeof text - (size_t)head, format, arguments);
    va_end(arguments);
    if (m->told & (error ? TELL_ERRORS : TELL_DISCARDS)) {
        report(m, status, error ? "logStatusError" : "logStatusDiscard", text);
    }
    return status;
}

static Status null(const Instance *m)
{
    return refused(m, FMI(Error), "a pointer is null");
}

/* Whether an array holds as many numbers as it has to. */
static int holds(const Instance *m, const void *array, size_t count, size_t expected)
{
    if (count != expected) {
        const unsigned has = (unsigned)count, needs = (unsigned)expected;
        refused(m, FMI(Error), "the array has %u elements, expected %u", has, needs);
        return 0;
    }
    if (count && !array) {
        null(m);
        return 0;
    }
    return 1;
}

static Status set_logging(Instance *m, int on, size_t count, const FMI(String) categories[])
{
    unsigned told = on && !count ? TELL_ALL : 0;
    for (size_t i = 0; i < count; ++i) {
        if (!categories || !categories[i]) {
            return null(m);
        }
        if (!strcmp(categories[i], "logStatusError")) {
            told |= TELL_ERRORS;
        } else if (!strcmp(categories[i], "logStatusDiscard")) {
            told |= TELL_DISCARDS;
        } else {
            return refused(m, FMI(Error), "a log category is unknown");
        }
    }
    m->told = on ? told : 0;
    return FMI(OK);
}

/* -- the state machine ------------------------------------------------------------------------- */

static const char *mode_name(int mode)
{
    switch (mode) {
    case INSTANTIATED: return "before initialization";
    case INITIALIZATION: return "in initialization mode";
    case CONTINUOUS: return "in continuous-time mode";
    case STEP: return "in step mode";
    case TERMINATED: return "after the end";
    default: return "in event mode";
    }
}

/* Whether a function may be called now. */
static int may(Instance *m, const char *function, int modes)
{
    if (!m) {
        return 0;
    }
    m->function = function;
    if (!(m->now.mode & modes)) {
        refused(m, FMI(Error), "must not be called %s", mode_name(m->now.mode));
        return 0;
    }
    return 1;
}

/* How each function with an instance begins. */
#define CALL(instance, modes)                 \
    Instance *const m = (Instance *)instance; \
    if (!may(m, __func__, modes)) {           \
        return FMI(Error);                    \
    }

static Status enter(Instance *m, int mode)
{
    m->now.mode = mode;
    return FMI(OK);
}

static Status initialized(Instance *m)
{
    static const int first[] = {EVENT, STEP, STEP_EVENT};
    return enter(m, first[m->now.kind]);
}

/* Everything as the description says. */
static void start(State *s)
{
    memset(s->value, 0, sizeof s->value);
    memcpy(s->value + PARAMETER, &DEFAULTS, sizeof(Params));
    s->value[MAX_STEP] = DEFAULT_MAX_STEP;
    s->mode = INSTANTIATED;
    s->stale = 1;
}

static Instance *create(
    const Listener *listener, unsigned told, const char *function, const char *name,
    const char *token, int kind)
{
    Instance *m = (Instance *)calloc(1, sizeof *m);
    if (!m) {
        return NULL;
    }
    m->listener = *listener;
    m->told = told;
    m->function = function;
    if (!name || !*name) {
        refused(m, FMI(Error), "the instance has no name");
    } else if (!token || strcmp(token, MODEL_TOKEN)) {
        refused(m, FMI(Error), "the token is not the one of modelDescription.xml");
    } else {
        strcpy(m->now.token, MODEL_TOKEN);
        m->now.kind = kind;
        start(&m->now);
        return m;
    }
    free(m);
    return NULL;
}

/* -- copies of the state ----------------------------------------------------------------------- */

static int fits(const Instance *m, const State *s)
{
    return !memcmp(s->token, m->now.token, sizeof s->token) && s->kind == m->now.kind;
}

/* The copy goes where one was, if any. */
static Status copy(const Instance *m, const State *from, void **to)
{
    if (!*to) {
        *to = malloc(sizeof(State));
    }
    if (!*to) {
        return refused(m, FMI(Error), "there is no memory left");
    }
    memcpy(*to, from, sizeof(State));
    return FMI(OK);
}

static Status save(const Instance *m, void **state)
{
    return state ? copy(m, &m->now, state) : null(m);
}

static Status restore(Instance *m, const void *state)
{
    if (!state) {
        return null(m);
    }
    if (!fits(m, (const State *)state)) {
        return refused(m, FMI(Error), "the state is of another model or interface");
    }
    memcpy(&m->now, state, sizeof(State));
    return FMI(OK);
}

static Status release(void **state)
{
    if (state) {
        free(*state);
        *state = NULL;
    }
    return FMI(OK);
}

static Status serialized_size(const Instance *m, const void *state, size_t *size)
{
    if (!state || !size) {
        return null(m);
    }
    *size = sizeof(State);
    return FMI(OK);
}

static Status serialize(const Instance *m, const void *state, void *bytes, size_t size)
{
    if (!state) {
        return null(m);
    }
    if (!holds(m, bytes, size, sizeof(State))) {
        return FMI(Error);
    }
    memcpy(bytes, state, sizeof(State));
    return FMI(OK);
}

static Status deserialize(const Instance *m, const void *bytes, size_t size, void **state)
{
    State s;
    if (!state) {
        return null(m);
    }
    if (!holds(m, bytes, size, sizeof s)) {
        return FMI(Error);
    }
    memcpy(&s, bytes, sizeof s);
    if (!fits(m, &s) || s.mode < INSTANTIATED || s.mode > TERMINATED || (s.mode & (s.mode - 1))) {
        return refused(m, FMI(Error), "these bytes are no state of this model and interface");
    }
    return copy(m, &s, state);
}

#endif
