/* Elementary functions that give the same bits on every platform: IEEE's operations and square roots alone, none
 * of a mathematical library, whose last bit depends on the machine. Within 1 ulp, the derived ones within 2. */
#ifndef JOINTFMU_ELEMENTARY_H
#define JOINTFMU_ELEMENTARY_H

double same_exp(double x);
double same_log(double x);
double same_pow(double x, double y);
double same_expm1(double x);
double same_log1p(double x);
double same_sinh(double x);
double same_cosh(double x);
double same_tanh(double x);
double same_asinh(double x);
double same_erf(double x);
double same_sin(double x);
double same_cos(double x);

#endif
