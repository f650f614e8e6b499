/* Repeats `Hysteresis` of the package; what a slider is follows from the law and is generated. */
#include "hysteresis.h"

#include <math.h>

enum { LOSS, STIFFNESS, RATED }; /* of the drive's numbers */

void midline(const Curve *curve, double phi, int order, double *y)
{
    curve_at(curve, fabs(phi), order, y);
    y[0] = copysign(y[0], phi);
    if (order == 2)
        y[2] = phi < 0.0 ? -y[2] : y[2];
}

double midline_inverse(const Curve *curve, double torque)
{
    double carried;
    int nearest = 0;
    return copysign(curve_inverse(curve, fabs(torque), &nearest, &carried), torque);
}

static inline double clamped(double trial, double limit)
{
    const double below = trial < limit ? trial : limit;
    return below > -limit ? below : -limit;
}

/* Sums in lanes, which a processor adds side by side. */
enum { LANES = 4 };
_Static_assert(SLIDERS % LANES == 0, "whole lanes");

static double sum(const double *lane)
{
    return (lane[0] + lane[1]) + (lane[2] + lane[3]);
}

Slid hysteresis_at(const Hysteresis *hysteresis, const double *memory, double phi)
{
    const double way = phi - memory[AT_WIND_UP];
    double torque[LANES] = {0.0}, loss[LANES] = {0.0}, tangent[LANES] = {0.0}, heat[LANES] = {0.0};
    for (int i = 0; i < SLIDERS; i += LANES)
        for (int k = 0; k < LANES; k++) {
            const double trial = memory[i + k] + hysteresis->spring[i + k] * way;
            const double force = clamped(trial, hysteresis->limit[i + k]), beyond = trial - force;
            torque[k] += force;
            loss[k] += force * beyond * hysteresis->compliance[i + k];
            tangent[k] += beyond == 0.0 ? hysteresis->spring[i + k] : 0.0;
            heat[k] += beyond == 0.0 ? 0.0 : force;
        }
    return (Slid){sum(torque), memory[AT_LOSS] + sum(loss), sum(tangent), sum(heat)};
}

/* The torque alone, and its tangent. */
static double torque_at(const Hysteresis *hysteresis, const double *memory, double phi, double *slope)
{
    const double way = phi - memory[AT_WIND_UP];
    double torque[LANES] = {0.0}, tangent[LANES] = {0.0};
    for (int i = 0; i < SLIDERS; i += LANES)
        for (int k = 0; k < LANES; k++) {
            const double trial = memory[i + k] + hysteresis->spring[i + k] * way;
            const double force = clamped(trial, hysteresis->limit[i + k]);
            torque[k] += force;
            tangent[k] += trial == force ? hysteresis->spring[i + k] : 0.0;
        }
    *slope = sum(tangent);
    return sum(torque);
}

void hysteresis_move(const Hysteresis *hysteresis, const double *before, double phi, double *after)
{
    const double way = phi - before[AT_WIND_UP];
    double loss[LANES] = {0.0};
    for (int i = 0; i < SLIDERS; i += LANES)
        for (int k = 0; k < LANES; k++) {
            const double trial = before[i + k] + hysteresis->spring[i + k] * way;
            const double force = clamped(trial, hysteresis->limit[i + k]);
            loss[k] += force * (trial - force) * hysteresis->compliance[i + k];
            after[i + k] = force;
        }
    after[AT_WIND_UP] = phi;
    after[AT_LOSS] = before[AT_LOSS] + sum(loss);
}

void hysteresis_rest(const double *before, double phi, double *after)
{
    for (int i = 0; i < SLIDERS; i++)
        after[i] = 0.0;
    after[AT_WIND_UP] = phi;
    after[AT_LOSS] = before[AT_LOSS];
}

double hysteresis_wind_up(const Hysteresis *hysteresis, const Curve *curve, const double *memory,
                          double torque)
{
    const double least = midline_inverse(curve, torque - hysteresis->most);
    const double largest = midline_inverse(curve, torque + hysteresis->most);
    double phi = fmin(fmax(memory[AT_WIND_UP], least), largest), low = -INFINITY, high = INFINITY;
    for (int k = 0; k < MOST_STEPS; k++) {
        double y[2], tangent;
        midline(curve, phi, 1, y);
        const double rest = torque - (y[0] + torque_at(hysteresis, memory, phi, &tangent));
        const double step = phi + rest / (y[1] + tangent);
        if (rest > 0.0)
            low = phi;
        else if (rest < 0.0)
            high = phi;
        const double next = step >= low && step <= high ? step : 0.5 * (low + high);
        const double change = fabs(next - phi);
        phi = next;
        if (change <= NEAREST * (fabs(phi) + hysteresis->length))
            break;
    }
    return phi;
}

/* Friction against the midline on the way back from a torque, at a wind-up. */
static double opening(const Hysteresis *hysteresis, const Curve *curve, double torque, double half)
{
    const double rest[SLIDERS + 2] = {0.0};
    const double turn = hysteresis_wind_up(hysteresis, curve, rest, torque);
    return 2.0 * hysteresis_at(hysteresis, rest, 0.5 * (turn - half)).torque -
        hysteresis_at(hysteresis, rest, turn).torque;
}

static double extra_stiffness(const double *head, const Curve *curve, double least)
{
    if (head[STIFFNESS] > 0.0)
        return head[STIFFNESS];
    const double back = curve_inverse_safe(curve, head[RATED] - least) - 0.5 * head[LOSS];
    return fmax(curve->first.s, 2.0 * REVERSAL * least / back);
}

static void refuse_loss(const double *head, const Curve *curve, Text *why)
{
    text_add(why, "hysteresis_loss = ");
    text_number(why, head[LOSS], 6);
    text_add(why, " rad is outside [0, ");
    text_number(why, 2.0 * curve_inverse_safe(curve, 0.5 * head[RATED]), 6);
    text_add(why, ") rad: friction would hold half of the rated torque");
}

static void refuse_stiffness(const double *head, Text *why)
{
    text_add(why, "hysteresis_stiffness = ");
    text_number(why, head[STIFFNESS], 6);
    text_add(why, " N.m/rad is too small for a loop through rated torque that opens by ");
    text_number(why, head[LOSS], 6);
    text_add(why, " rad; allowed are 0 and larger ones");
}

static void set_limit(Hysteresis *hysteresis, const double *share, double limit, double stiffness)
{
    hysteresis->acts = limit > 0.0;
    hysteresis->most = limit;
    hysteresis->length = limit / stiffness;
    for (int i = 0; i < SLIDERS; i++)
        hysteresis->limit[i] = limit * share[SLIDERS + i];
}

bool hysteresis_of(Hysteresis *hysteresis, const double *head, const double *share, const Curve *curve,
                   Text *why)
{
    double y[2];
    curve_at(curve, 0.5 * head[LOSS], 1, y);
    const double least = y[0];
    if (!(least < 0.5 * head[RATED])) {
        refuse_loss(head, curve, why);
        return false;
    }
    const double stiffness = extra_stiffness(head, curve, least);
    for (int i = 0; i < SLIDERS; i++) {
        hysteresis->spring[i] = stiffness * share[i];
        hysteresis->compliance[i] = 1.0 / hysteresis->spring[i];
    }
    double limit = least;
    for (int k = 0; k < MOST_CORRECTIONS; k++) {
        set_limit(hysteresis, share, limit, stiffness);
        if (!hysteresis->acts)
            return true;
        const double before = limit, open = opening(hysteresis, curve, head[RATED], 0.5 * head[LOSS]);
        limit *= open > 0.0 ? least / open : INFINITY;
        if (!(limit < head[RATED]))
            break;
        if (fabs(limit - before) <= SETTLED * limit)
            return true;
    }
    refuse_stiffness(head, why);
    return false;
}
