/* Repeats `Friction` of the package; the limit of the friction is generated. */
#include "friction.h"

_Static_assert(BRAKES % 4 == 0, "as sliders_line needs them");

void friction_of(Friction *friction, double stiffness)
{
    friction->acts = stiffness > 0.0;
    for (int i = 0; i < BRAKES; i++) {
        friction->K[i] = stiffness * BRAKE_SPRINGS[i];
        friction->per_K[i] = friction->acts ? 1.0 / friction->K[i] : 0.0;
    }
}

/* On the first path the drive has turned to where it is. */
static double way(const double *memory, Turn turn)
{
    return memory[AT_BEGUN] > 0.0 ? turn.angle - memory[AT_ANGLE] : TURNED * turn.speed;
}

static void limits_at(double limit, double *each)
{
    for (int i = 0; i < BRAKES; i++)
        each[i] = limit * BRAKE_LIMITS[i];
}

SliderSum friction_at(const Friction *friction, const double *memory, Turn turn, double *after)
{
    double start[BRAKES], end[BRAKES];
    limits_at(memory[AT_LIMIT], start);
    limits_at(turn.limit, end);
    const Sliders s = {friction->K, friction->per_K, start, end, {memory, NULL}};
    SliderSum sum;
    sliders_line(BRAKES, &s, way(memory, turn), after, &sum);
    after[AT_ANGLE] = turn.angle;
    after[AT_LIMIT] = turn.limit;
    after[AT_BEGUN] = 1.0;
    if (!(memory[AT_BEGUN] > 0.0))
        sum.loss = 0.0;
    return sum;
}

SliderSum friction_rate(const Friction *friction, const double *memory, Turn turn, Turn rate)
{
    const bool begun = memory[AT_BEGUN] > 0.0;
    double start[BRAKES], end[BRAKES], rises[BRAKES];
    limits_at(memory[AT_LIMIT], start);
    limits_at(turn.limit, end);
    limits_at(rate.limit, rises);
    const Sliders s = {friction->K, friction->per_K, start, end, {memory, NULL}};
    SliderSum sum;
    sliders_line_rate(BRAKES, &s, way(memory, turn), begun ? rate.angle : TURNED * rate.speed, rises, &sum);
    if (!begun)
        sum.loss = 0.0;
    return sum;
}
