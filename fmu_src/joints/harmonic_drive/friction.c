/* Repeats `Friction` of the package; the limit of the friction is generated. */
#include "friction.h"

#include <math.h>

void friction_of(Friction *friction, double stiffness)
{
    friction->acts = stiffness > 0.0;
    for (int i = 0; i < BRAKES; i++) {
        friction->spring[i] = stiffness * BRAKE_SPRINGS[i];
        friction->compliance[i] = friction->acts ? 1.0 / friction->spring[i] : 0.0;
    }
}

/* On the first path the drive has turned to where it is. */
static double way(const double *memory, Turn turn)
{
    return memory[AT_BEGUN] > 0.0 ? turn.angle - memory[AT_ANGLE] : TURNED * turn.speed;
}

/* A slider at the end of a path. */
typedef struct {
    double force, side, beyond; /* side: the sign of the slip */
    double start, end, onset;   /* limits, and the part of the path [1] on which it sticks */
    double rest;                /* margin and beyond */
} Slider;

static Slider slider(const Friction *friction, const double *memory, Turn turn, double moved, int i)
{
    const double trial = memory[i] + friction->spring[i] * moved, end = turn.limit * BRAKE_LIMITS[i];
    const double start = memory[AT_LIMIT] * BRAKE_LIMITS[i], size = fabs(trial);
    if (!(size > end))
        return (Slider){trial, 0.0, 0.0, start, end, 0.0, 1.0};
    const double side = copysign(1.0, trial), beyond = size - end;
    const double margin = fmax(start - side * memory[i], 0.0), rest = margin + beyond;
    return (Slider){side * end, side, beyond, start, end, margin / rest, rest};
}

Braked friction_at(const Friction *friction, const double *memory, Turn turn)
{
    const double moved = way(memory, turn);
    Braked sum = {0.0, 0.0};
    for (int i = 0; i < BRAKES; i++) {
        const Slider s = slider(friction, memory, turn, moved, i);
        sum.torque += s.force;
        sum.loss += 0.5 * (s.start + s.end + s.onset * (s.end - s.start)) * s.beyond * friction->compliance[i];
    }
    if (!(memory[AT_BEGUN] > 0.0))
        sum.loss = 0.0;
    return sum;
}

Braked friction_rate(const Friction *friction, const double *memory, Turn turn, Turn rate)
{
    const bool begun = memory[AT_BEGUN] > 0.0;
    const double moved = way(memory, turn), moves = begun ? rate.angle : TURNED * rate.speed;
    Braked sum = {0.0, 0.0};
    for (int i = 0; i < BRAKES; i++) {
        const Slider s = slider(friction, memory, turn, moved, i);
        if (s.side == 0.0) {
            sum.torque += friction->spring[i] * moves;
            continue;
        }
        const double end = rate.limit * BRAKE_LIMITS[i], rise = s.end - s.start;
        const double beyond = s.side * friction->spring[i] * moves - end, onset = -s.onset / s.rest * beyond;
        const double mean = s.start + s.end + s.onset * rise, drift = end + onset * rise + s.onset * end;
        sum.torque += s.side * end;
        sum.loss += 0.5 * (drift * s.beyond + mean * beyond) * friction->compliance[i];
    }
    if (!begun)
        sum.loss = 0.0;
    return sum;
}

void friction_move(const Friction *friction, const double *before, Turn turn, double *after)
{
    const double moved = way(before, turn);
    for (int i = 0; i < BRAKES; i++)
        after[i] = slider(friction, before, turn, moved, i).force;
    after[AT_ANGLE] = turn.angle;
    after[AT_LIMIT] = turn.limit;
    after[AT_BEGUN] = 1.0;
}

void friction_rest(double *after)
{
    for (int i = 0; i < N_BRAKES; i++)
        after[i] = 0.0;
}
