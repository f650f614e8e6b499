/* Exponential and logarithm by a table of 32 places and a short polynomial (P. T. P. Tang, ACM Trans. Math.
 * Softw. 15 and 16), with a second double for what the first one loses where the result needs it. */
#include "elementary.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

#include "elementary_tables.h" /* generated */

/* Added and subtracted: rounds to a whole number. */
#define SHIFTER 0x1.8p52

typedef struct {
    double high, low;
} Pair;

static inline uint64_t bits_of(double x)
{
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

static inline double from_bits(uint64_t bits)
{
    double x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

/* The first 26 bits of a number: products of two such are exact. */
static inline double first_half(double x)
{
    return from_bits(bits_of(x) & 0xfffffffff8000000);
}

static inline Pair sum_of(double a, double b)
{
    const double sum = a + b, part = sum - a;
    return (Pair){sum, (a - (sum - part)) + (b - part)};
}

/* The same where the first one is not the smaller one, or zero. */
static inline Pair larger_first(double a, double b)
{
    const double sum = a + b;
    return (Pair){sum, (a - sum) + b};
}

/* exp(high + low); low is small beside 1. */
static double exponential(double high, double low)
{
    if (!(high < 800.0))
        return high > 0.0 ? INFINITY : high;
    if (high < -800.0)
        return 0.0;
    const double k = (high * PLACES_PER_LOG_2 + SHIFTER) - SHIFTER;
    const double r = ((high - k * LOG_2_PER_PLACE) - k * LOG_2_PER_PLACE_LOW) + low;
    const int whole = (int)k, place = whole & (PLACES - 1), power = (whole - place) / PLACES;
    const double square = r * r;
    const double last = (1.0 / 24.0 + r * (1.0 / 120.0)) + square * (1.0 / 720.0 + r * (1.0 / 5040.0));
    const double more = POWERS[place][1] + r + square * (0.5 + r * (1.0 / 6.0)) + square * square * last;
    const int half = power / 2;
    const double one = from_bits((uint64_t)(1023 + half) << 52), other = from_bits((uint64_t)(1023 + power - half) << 52);
    return (POWERS[place][0] + POWERS[place][0] * more) * one * other;
}

/* A positive finite number as 2^k z, z near the number c of a row: 1/c of few bits, log(c) as two doubles. */
typedef struct {
    double k, r, r_low; /* r + r_low is z/c - 1 */
    const double *row;
} Place;

static inline Place place_of(double x)
{
    int power = 0;
    if (x < 0x1p-1022) {
        x *= 0x1p54;
        power = -54;
    }
    const uint64_t bits = bits_of(x), from = bits - LOG_BEGIN;
    const int raised = (int)((int64_t)from >> 52);
    const double *row = LOGS[(from >> LOG_BITS) & (PLACES - 1)];
    const double z = from_bits(bits - ((uint64_t)raised << 52));
    const double z_first = from_bits((bits_of(z) + 0x80000000) & 0xffffffff00000000);
    const Pair r = sum_of(z_first * row[0] - 1.0, (z - z_first) * row[0]);
    return (Place){(double)(power + raised), r.high, r.low, row};
}

/* (log(1 + r) - r + r^2/2) / r^3 */
static inline double series(double r)
{
    const double square = r * r, last = (1.0 / 7.0 - r * 0.125) + square * ((1.0 / 9.0 - r * 0.1) + square * (1.0 / 11.0));
    return ((1.0 / 3.0 - r * 0.25) + square * (0.2 - r * (1.0 / 6.0))) + square * square * last;
}

/* log(x) of a positive finite number; the second double holds what the first one lacks. */
static inline Pair logarithm(double x)
{
    const Place at = place_of(x);
    const double r = at.r, first = first_half(r), rest = r - first;
    const double square = -0.5 * first * first, square_low = -0.5 * rest * (r + first);
    const Pair a = larger_first(at.k * LOG_2 + at.row[1], r), b = larger_first(a.high, square);
    const double low = a.low + b.low + (at.k * LOG_2_LOW + at.row[2]) + at.r_low + square_low + r * r * r * series(r);
    return larger_first(b.high, low);
}

double same_exp(double x)
{
    return exponential(x, 0.0);
}

double same_log(double x)
{
    if (!(x > 0.0))
        return x == 0.0 ? -INFINITY : NAN;
    if (!(x < INFINITY))
        return x;
    const Place at = place_of(x);
    const double small = at.k * LOG_2_LOW + at.row[2], r = at.r;
    return (at.k * LOG_2 + at.row[1]) + (r + (small + r * r * (r * series(r) - 0.5)));
}

/* of a positive finite x */
static double power_of(double x, double y)
{
    const Pair log_x = logarithm(x);
    const double high = y * log_x.high;
    if (!(fabs(high) < 800.0))
        return exponential(high, 0.0);
    const double a = first_half(y), b = first_half(log_x.high), c = y - a, d = log_x.high - b;
    return exponential(high, (((a * b - high) + a * d) + c * b) + c * d + y * log_x.low);
}

double same_pow(double x, double y)
{
    if (x > 0.0 && x < INFINITY && fabs(y) < INFINITY)
        return power_of(x, y);
    if (!(x < 0.0 && x > -INFINITY && fabs(y) < INFINITY && floor(y) == y))
        return pow(x, y); /* 0, 1, infinity or none */
    const double size = power_of(-x, y);
    return floor(0.5 * y) == 0.5 * y ? size : -size;
}

double same_expm1(double x)
{
    if (!(fabs(x) < 0.5))
        return same_exp(x) - 1.0;
    double sum = 0.0;
    for (int n = N_EXPM1 - 1; n >= 0; n--)
        sum = EXPM1[n] + x * sum;
    return x + x * x * sum;
}

double same_log1p(double x)
{
    const double u = 1.0 + x;
    if (!(u > 0.0 && u < INFINITY))
        return same_log(u);
    const Pair log_u = logarithm(u);
    const double lost = fabs(x) < 1.0 ? x - (u - 1.0) : 1.0 - (u - x);
    return log_u.high + (log_u.low + lost / u);
}

double same_sinh(double x)
{
    const double size = fabs(x);
    if (size > 30.0) {
        const double root = same_exp(0.5 * size);
        return copysign(0.5 * root * root, x);
    }
    const double t = same_expm1(size);
    return copysign(0.5 * (t + t / (t + 1.0)), x);
}

double same_cosh(double x)
{
    const double size = fabs(x);
    if (size > 30.0)
        return fabs(same_sinh(size));
    const double e = same_exp(size);
    return 0.5 * (e + 1.0 / e);
}

double same_tanh(double x)
{
    if (fabs(x) > 20.0)
        return copysign(1.0, x);
    const double t = same_expm1(2.0 * fabs(x));
    return copysign(t / (t + 2.0), x);
}

double same_asinh(double x)
{
    const double size = fabs(x);
    if (!(size < 1e8))
        return copysign(same_log(size) + (LOG_2 + LOG_2_LOW), x);
    return copysign(same_log1p(size + size * size / (1.0 + sqrt(size * size + 1.0))), x);
}

double same_erf(double x)
{
    const double size = fabs(x), place = (size * ERF_PER_PLACE + SHIFTER) - SHIFTER;
    if (!(size < 6.0))
        return x != x ? x : copysign(1.0, x);
    const double *a = ERF[(int)place], t = size - place * (1.0 / ERF_PER_PLACE);
    double sum = 0.0;
    for (int n = N_ERF - 1; n > 0; n--)
        sum = a[n] + t * sum;
    return copysign(a[0] + t * sum, x);
}

/* x less its next multiple k of pi/2. */
static inline Pair reduced(double x, double *k)
{
    *k = (x * TURNS + SHIFTER) - SHIFTER;
    const Pair y = sum_of(x - *k * QUARTER[0], -*k * QUARTER[1]);
    return sum_of(y.high, y.low - *k * QUARTER[2] - *k * QUARTER[3]);
}

static inline double sine(Pair y)
{
    const double z = y.high * y.high;
    double sum = 0.0;
    for (int n = N_WAVE - 1; n >= 0; n--)
        sum = SINE[n] + z * sum;
    return y.high + (y.low * (1.0 - 0.5 * z) + y.high * z * sum);
}

static inline double cosine(Pair y)
{
    const double z = y.high * y.high, half = 0.5 * z, first = 1.0 - half;
    double sum = 0.0;
    for (int n = N_WAVE - 1; n >= 0; n--)
        sum = COSINE[n] + z * sum;
    return first + (((1.0 - first) - half) + (z * z * sum - y.high * y.low));
}

/* sin(x + quarters pi/2) */
static double wave(double x, int quarters)
{
    double k;
    if (!(fabs(x) < INFINITY))
        return NAN;
    const Pair y = reduced(x, &k);
    const int quarter = ((int)(k - 4.0 * floor(0.25 * k)) + quarters) & 3;
    const double value = quarter & 1 ? cosine(y) : sine(y);
    return quarter & 2 ? -value : value;
}

double same_sin(double x)
{
    return wave(x, 0);
}

double same_cos(double x)
{
    return wave(x, 1);
}
