/* Repeats `Friction` of the package; the limits of the friction are generated. */
#include "harmonic_drive.h"

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

/* Each slider is held by the limit on the side of the force that it would have if it stuck. */
static void limits_at(const Friction *friction, const double *memory, double shift, const double *limit,
                      double *each)
{
    for (int i = 0; i < BRAKES; i++)
        each[i] = limit[memory[AT_BRAKE + i] + friction->K[i] * shift < 0.0] * BRAKE_LIMITS[i];
}

SliderSum friction_at(const Friction *friction, const double *memory, Turn turn, double *after)
{
    double start[BRAKES], end[BRAKES];
    const double shift = way(memory, turn);
    limits_at(friction, memory, shift, memory + AT_LIMIT, start);
    limits_at(friction, memory, shift, turn.limit, end);
    const Sliders s = {friction->K, friction->per_K, start, end, {memory + AT_BRAKE, NULL}};
    SliderSum sum;
    sliders_line(BRAKES, &s, shift, after + AT_BRAKE, &sum);
    after[AT_ANGLE] = turn.angle;
    after[AT_LIMIT] = turn.limit[0];
    after[AT_LIMIT + 1] = turn.limit[1];
    after[AT_BEGUN] = 1.0;
    if (!(memory[AT_BEGUN] > 0.0))
        sum.loss = 0.0;
    return sum;
}

SliderSum friction_rate(const Friction *friction, const double *memory, Turn turn, Turn rate)
{
    const bool begun = memory[AT_BEGUN] > 0.0;
    double start[BRAKES], end[BRAKES], rises[BRAKES];
    const double shift = way(memory, turn);
    limits_at(friction, memory, shift, memory + AT_LIMIT, start);
    limits_at(friction, memory, shift, turn.limit, end);
    limits_at(friction, memory, shift, rate.limit, rises);
    const Sliders s = {friction->K, friction->per_K, start, end, {memory + AT_BRAKE, NULL}};
    SliderSum sum;
    sliders_line_rate(BRAKES, &s, shift, begun ? rate.angle : TURNED * rate.speed, rises, &sum);
    if (!begun)
        sum.loss = 0.0;
    return sum;
}
