/* Elementary functions with the same bits on every platform: they use IEEE operations and square roots only. The last
 * bit of a mathematical library depends on the machine. exp, log and pow are within 1 ulp, the functions derived from
 * them within 2. */
#ifndef JOINTFMU_ELEMENTARY_H
#define JOINTFMU_ELEMENTARY_H

double portable_exp(double x);
double portable_log(double x);
double portable_pow(double x, double y);
double portable_expm1(double x);
double portable_log1p(double x);
double portable_sinh(double x);
double portable_cosh(double x);
double portable_tanh(double x);
double portable_asinh(double x);
double portable_erf(double x);
double portable_sin(double x);
double portable_cos(double x);
double portable_sin_cos(double x, double *cosine); /* returns the sine */

#endif
