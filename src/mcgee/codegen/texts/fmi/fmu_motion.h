/* What the FMUs of both versions share: the variables, the equations of motion, and the steps of
 * co-simulation. */

#ifndef FMU_MOTION_H
#define FMU_MOTION_H

#include "fmu.h"

/* -- the equations of motion ------------------------------------------------------------------- */

static Params parameters(const State *s)
{
    Params p;
    memcpy(&p, s->value + PARAMETER, sizeof p);
    return p;
}

static void refresh(State *s)
{
    if (s->stale) {
        double *v = s->value;
        const Params p = parameters(s);
        memcpy(v + DER_Q, v + QD, JOINTS*sizeof(double));
        FORWARD_DYNAMICS(v + Q, v + QD, v + TAU, &p, v + QDD);
        KINETIC_ENERGY(v + Q, v + QD, &p, v + KINETIC);
        POTENTIAL_ENERGY(v + Q, &p, v + POTENTIAL);
        v[TOTAL] = v[KINETIC] + v[POTENTIAL];
        s->stale = 0;
    }
}

/* One step of the classical Runge-Kutta method, with tau held. */
static void runge_kutta(double x[STATES], const double tau[JOINTS], const Params *p, double h)
{
    static const double reach[4] = {0.0, 0.5, 0.5, 1.0};
    static const double share[4] = {1.0/6.0, 1.0/3.0, 1.0/3.0, 1.0/6.0};
    double at[STATES], slope[STATES] = {0}, end[STATES];
    memcpy(end, x, sizeof end);
    for (int stage = 0; stage < 4; ++stage) {
        for (int i = 0; i < STATES; ++i) {
            at[i] = x[i] + h*reach[stage]*slope[i];
        }
        memcpy(slope, at + JOINTS, JOINTS*sizeof(double));
        FORWARD_DYNAMICS(at, at + JOINTS, tau, p, slope + JOINTS);
        for (int i = 0; i < STATES; ++i) {
            end[i] += h*share[stage]*slope[i];
        }
    }
    memcpy(x, end, sizeof end);
}

static int all_finite(const double x[], int count)
{
    for (int i = 0; i < count; ++i) {
        if (!isfinite(x[i])) {
            return 0;
        }
    }
    return 1;
}

/* From t to t + h in equal steps of at most max_step, to the rounding of times. */
static Status advance(Instance *m, double t, double h)
{
    double *v = m->now.value, x[STATES];
    const double steps = fmax(1.0, ceil(h/v[MAX_STEP]*(1.0 - 1e-9)));
    const Params p = parameters(&m->now);
    m->discarded = 0;
    if (!(h > 0.0 && isfinite(h))) {
        return refused(m, FMI(Error), "the step is %g s, expected more than 0", h);
    }
    if (!(fabs(t - v[TIME]) <= 1e-6*h + 1e-12*fabs(t))) {
        return refused(m, FMI(Error), "the step begins at %.17g s, expected %.17g", t, v[TIME]);
    }
    if (!(steps <= MOST_STEPS)) {
        return refused(m, FMI(Error), "a step of %g s takes %g steps of max_step", h, steps);
    }
    memcpy(x, v + Q, sizeof x);
    for (double k = 0.0; k < steps; ++k) {
        runge_kutta(x, v + TAU, &p, h/steps);
    }
    if (!all_finite(x, STATES)) {
        m->discarded = 1;
        return refused(m, FMI(Discard), "from %g s on the state becomes infinite or NaN", t);
    }
    memcpy(v + Q, x, sizeof x);
    v[TIME] = t + h;
    m->now.stale = 1;
    return FMI(OK);
}

/* -- variables --------------------------------------------------------------------------------- */

static Status known(const Instance *m, const Reference vr[], size_t count, const void *value)
{
    if (count && (!vr || !value)) {
        return null(m);
    }
    for (size_t i = 0; i < count; ++i) {
        if (vr[i] >= VARIABLES) {
            return refused(m, FMI(Error), "value reference %u is unknown", (unsigned)vr[i]);
        }
    }
    return FMI(OK);
}

static Status get(Instance *m, const Reference vr[], size_t count, double value[])
{
    if (known(m, vr, count, value) != FMI(OK)) {
        return FMI(Error);
    }
    for (size_t i = 0; i < count; ++i) {
        if (vr[i] >= CALCULATED) {
            refresh(&m->now);
        }
        value[i] = m->now.value[vr[i]];
    }
    return FMI(OK);
}

/* The modes in which a variable may be set. */
static int settable(Reference vr)
{
    const int before = INSTANTIATED | INITIALIZATION;
    const int tunable = before | EVENT | STEP_EVENT | STEP;
    if (vr < TAU || vr >= CALCULATED) {
        return 0;
    }
    return vr < Q ? tunable | CONTINUOUS : vr < PARAMETER ? before : tunable;
}

static Status set(Instance *m, const Reference vr[], size_t count, const double value[])
{
    if (known(m, vr, count, value) != FMI(OK)) {
        return FMI(Error);
    }
    for (size_t i = 0; i < count; ++i) {
        const unsigned which = (unsigned)vr[i];
        if (!(settable(vr[i]) & m->now.mode)) {
            const char *now = mode_name(m->now.mode);
            return refused(m, FMI(Error), "value reference %u cannot be set %s", which, now);
        }
        if (vr[i] == MAX_STEP && !(value[i] > 0.0 && isfinite(value[i]))) {
            return refused(m, FMI(Error), "max_step is %g s, expected more than 0", value[i]);
        }
    }
    for (size_t i = 0; i < count; ++i) {
        m->now.value[vr[i]] = value[i];
    }
    m->now.stale = 1;
    return FMI(OK);
}

/* For types of which there are no variables. */
static Status none(const Instance *m, size_t count)
{
    return count ? refused(m, FMI(Error), "there are no variables of this type") : FMI(OK);
}

/* -- model exchange ---------------------------------------------------------------------------- */

static Status get_states(const Instance *m, double x[], size_t count)
{
    if (!holds(m, x, count, STATES)) {
        return FMI(Error);
    }
    memcpy(x, m->now.value + Q, STATES*sizeof(double));
    return FMI(OK);
}

static Status set_states(Instance *m, const double x[], size_t count)
{
    if (!holds(m, x, count, STATES)) {
        return FMI(Error);
    }
    memcpy(m->now.value + Q, x, STATES*sizeof(double));
    m->now.stale = 1;
    return FMI(OK);
}

static Status get_derivatives(Instance *m, double dx[], size_t count)
{
    if (!holds(m, dx, count, STATES)) {
        return FMI(Error);
    }
    refresh(&m->now);
    memcpy(dx, m->now.value + DER_Q, STATES*sizeof(double));
    return all_finite(dx, STATES) ? FMI(OK) : refused(m, FMI(Discard), "one is infinite or NaN");
}

static Status get_nominals(const Instance *m, double nominal[], size_t count)
{
    if (!holds(m, nominal, count, STATES)) {
        return FMI(Error);
    }
    for (int i = 0; i < STATES; ++i) {
        nominal[i] = 1.0;
    }
    return FMI(OK);
}

static Status set_time(Instance *m, double time)
{
    m->now.value[TIME] = time;
    return FMI(OK);
}

#endif
