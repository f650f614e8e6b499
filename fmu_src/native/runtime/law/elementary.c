/* Exponential and logarithm by a table of 32 intervals and a short polynomial (P. T. P. Tang, ACM Trans. Math. Softw.
 * 15 and 16). Where the result needs it, a number is the sum of two doubles. */
#include "elementary.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

#include "elementary_tables.h" /* generated */

/* Number whose addition and subtraction round a double to an integer. */
#define ROUNDING_SHIFT 0x1.8p52

typedef struct {
    double high, low;
} DoubleDouble;

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

/* Number with its 26 leading bits only: products of two such numbers are exact. */
static inline double high_bits(double x)
{
    return from_bits(bits_of(x) & 0xfffffffff8000000);
}

/* a + b and its round-off. */
static inline DoubleDouble two_sum(double a, double b)
{
    const double sum = a + b, part = sum - a;
    return (DoubleDouble){sum, (a - (sum - part)) + (b - part)};
}

/* a + b and its round-off, if |a| >= |b| or a is zero. */
static inline DoubleDouble fast_two_sum(double a, double b)
{
    const double sum = a + b;
    return (DoubleDouble){sum, (a - sum) + b};
}

/* exp(high + low), with |low| much smaller than 1. */
static double exponential(double high, double low)
{
    if (!(high < 800.0))
        return high > 0.0 ? INFINITY : high;
    if (high < -800.0)
        return 0.0;
    const double k = (high * INTERVALS_PER_LOG_2 + ROUNDING_SHIFT) - ROUNDING_SHIFT;
    const double r = ((high - k * LOG_2_PER_INTERVAL) - k * LOG_2_PER_INTERVAL_LOW) + low;
    const int whole = (int)k, interval = whole & (EXP_LOG_TABLE_INTERVALS - 1);
    const int power = (whole - interval) / EXP_LOG_TABLE_INTERVALS;
    const double square = r * r;
    const double last = (1.0 / 24.0 + r * (1.0 / 120.0)) + square * (1.0 / 720.0 + r * (1.0 / 5040.0));
    const double more = EXP_TABLE[interval][1] + r + square * (0.5 + r * (1.0 / 6.0)) + square * square * last;
    const int half = power / 2;
    const double one = from_bits((uint64_t)(1023 + half) << 52),
                 other = from_bits((uint64_t)(1023 + power - half) << 52);
    return (EXP_TABLE[interval][0] + EXP_TABLE[interval][0] * more) * one * other;
}

/* Positive finite number as 2^k z, z near the number c of a row of LOG_TABLE: 1/c with few bits, log(c) as two
 * doubles. */
typedef struct {
    double k, r, r_low; /* r + r_low is z/c - 1 */
    const double *row;
} ReducedLogArgument;

static inline ReducedLogArgument reduce_log_argument(double x)
{
    int power = 0;
    if (x < 0x1p-1022) {
        x *= 0x1p54;
        power = -54;
    }
    const uint64_t bits = bits_of(x), from = bits - LOG_BEGIN;
    const int raised = (int)((int64_t)from >> 52);
    const double *row = LOG_TABLE[(from >> LOG_BITS) & (EXP_LOG_TABLE_INTERVALS - 1)];
    const double z = from_bits(bits - ((uint64_t)raised << 52));
    const double z_first = from_bits((bits_of(z) + 0x80000000) & 0xffffffff00000000);
    const DoubleDouble r = two_sum(z_first * row[0] - 1.0, (z - z_first) * row[0]);
    return (ReducedLogArgument){(double)(power + raised), r.high, r.low, row};
}

/* (log(1 + r) - r + r^2/2) / r^3 */
static inline double log_series(double r)
{
    const double square = r * r,
                 last = (1.0 / 7.0 - r * 0.125) + square * ((1.0 / 9.0 - r * 0.1) + square * (1.0 / 11.0));
    return ((1.0 / 3.0 - r * 0.25) + square * (0.2 - r * (1.0 / 6.0))) + square * square * last;
}

/* log(x) of a positive finite number as two doubles. */
static inline DoubleDouble logarithm(double x)
{
    const ReducedLogArgument reduced = reduce_log_argument(x);
    const double r = reduced.r, first = high_bits(r), rest = r - first;
    const double square = -0.5 * first * first, square_low = -0.5 * rest * (r + first);
    const DoubleDouble a = fast_two_sum(reduced.k * LOG_2 + reduced.row[1], r), b = fast_two_sum(a.high, square);
    const double low = a.low + b.low + (reduced.k * LOG_2_LOW + reduced.row[2]) + reduced.r_low + square_low +
                       r * r * r * log_series(r);
    return fast_two_sum(b.high, low);
}

double portable_exp(double x)
{
    return exponential(x, 0.0);
}

double portable_log(double x)
{
    if (!(x > 0.0))
        return x == 0.0 ? -INFINITY : NAN;
    if (!(x < INFINITY))
        return x;
    const ReducedLogArgument reduced = reduce_log_argument(x);
    const double small = reduced.k * LOG_2_LOW + reduced.row[2], r = reduced.r;
    return (reduced.k * LOG_2 + reduced.row[1]) + (r + (small + r * r * (r * log_series(r) - 0.5)));
}

/* x^y of a positive finite x. */
static double positive_power(double x, double y)
{
    const DoubleDouble log_x = logarithm(x);
    const double high = y * log_x.high;
    if (!(fabs(high) < 800.0))
        return exponential(high, 0.0);
    const double a = high_bits(y), b = high_bits(log_x.high), c = y - a, d = log_x.high - b;
    return exponential(high, (((a * b - high) + a * d) + c * b) + c * d + y * log_x.low);
}

double portable_pow(double x, double y)
{
    if (x > 0.0 && x < INFINITY && fabs(y) < INFINITY)
        return positive_power(x, y);
    if (!(x < 0.0 && x > -INFINITY && fabs(y) < INFINITY && floor(y) == y))
        return pow(x, y); /* exact: 0, 1, infinity or NaN */
    const double size = positive_power(-x, y);
    return floor(0.5 * y) == 0.5 * y ? size : -size;
}

double portable_expm1(double x)
{
    if (!(fabs(x) < 0.5))
        return portable_exp(x) - 1.0;
    double sum = 0.0;
    for (int n = N_EXPM1_TERMS - 1; n >= 0; n--)
        sum = EXPM1_SERIES[n] + x * sum;
    return x + x * x * sum;
}

double portable_log1p(double x)
{
    const double u = 1.0 + x;
    if (!(u > 0.0 && u < INFINITY))
        return portable_log(u);
    const DoubleDouble log_u = logarithm(u);
    const double lost = fabs(x) < 1.0 ? x - (u - 1.0) : 1.0 - (u - x);
    return log_u.high + (log_u.low + lost / u);
}

double portable_sinh(double x)
{
    const double size = fabs(x);
    if (size > 30.0) {
        const double root = portable_exp(0.5 * size);
        return copysign(0.5 * root * root, x);
    }
    const double t = portable_expm1(size);
    return copysign(0.5 * (t + t / (t + 1.0)), x);
}

double portable_cosh(double x)
{
    const double size = fabs(x);
    if (size > 30.0)
        return fabs(portable_sinh(size));
    const double e = portable_exp(size);
    return 0.5 * (e + 1.0 / e);
}

double portable_tanh(double x)
{
    if (fabs(x) > 20.0)
        return copysign(1.0, x);
    const double t = portable_expm1(2.0 * fabs(x));
    return copysign(t / (t + 2.0), x);
}

double portable_asinh(double x)
{
    const double size = fabs(x);
    if (!(size < 1e8))
        return copysign(portable_log(size) + (LOG_2 + LOG_2_LOW), x);
    return copysign(portable_log1p(size + size * size / (1.0 + sqrt(size * size + 1.0))), x);
}

double portable_erf(double x)
{
    const double size = fabs(x), interval = (size * ERF_NODES_PER_UNIT + ROUNDING_SHIFT) - ROUNDING_SHIFT;
    if (!(size < 6.0))
        return x != x ? x : copysign(1.0, x);
    const double *a = ERF_TABLE[(int)interval], t = size - interval * (1.0 / ERF_NODES_PER_UNIT);
    double sum = 0.0;
    for (int n = N_ERF_TERMS - 1; n > 0; n--)
        sum = a[n] + t * sum;
    return copysign(a[0] + t * sum, x);
}

/* x minus the nearest multiple k of pi/2. */
static inline DoubleDouble reduce_to_quarter_turn(double x, double *k)
{
    *k = (x * QUARTERS_PER_RADIAN + ROUNDING_SHIFT) - ROUNDING_SHIFT;
    const DoubleDouble y = two_sum(x - *k * QUARTER_TURN[0], -*k * QUARTER_TURN[1]);
    return two_sum(y.high, y.low - *k * QUARTER_TURN[2] - *k * QUARTER_TURN[3]);
}

static inline double sine_near_zero(DoubleDouble y)
{
    const double z = y.high * y.high;
    double sum = 0.0;
    for (int n = N_SINE_TERMS - 1; n >= 0; n--)
        sum = SINE_SERIES[n] + z * sum;
    return y.high + (y.low * (1.0 - 0.5 * z) + y.high * z * sum);
}

static inline double cosine_near_zero(DoubleDouble y)
{
    const double z = y.high * y.high, half = 0.5 * z, first = 1.0 - half;
    double sum = 0.0;
    for (int n = N_SINE_TERMS - 1; n >= 0; n--)
        sum = COSINE_SERIES[n] + z * sum;
    return first + (((1.0 - first) - half) + (z * z * sum - y.high * y.low));
}

double portable_sin_cos(double x, double *cosine)
{
    double k;
    if (!(fabs(x) < INFINITY))
        return *cosine = NAN;
    const DoubleDouble y = reduce_to_quarter_turn(x, &k);
    const int quarter = (int)(k - 4.0 * floor(0.25 * k));
    const double a = sine_near_zero(y), b = cosine_near_zero(y);
    const double sine = quarter & 1 ? b : a, other = quarter & 1 ? a : b;
    *cosine = (quarter + 1) & 2 ? -other : other;
    return quarter & 2 ? -sine : sine;
}

double portable_sin(double x)
{
    double cosine;
    return portable_sin_cos(x, &cosine);
}

double portable_cos(double x)
{
    double cosine;
    portable_sin_cos(x, &cosine);
    return cosine;
}
