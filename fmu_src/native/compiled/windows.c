/* Functions that the C runtime library of Windows does not export: snprintf, which Microsoft defines in its headers
 * only, and sincos. */
#include <math.h>
#include <stdarg.h>
#include <stddef.h>

int __stdio_common_vsprintf(unsigned long long options, char *buffer, size_t size, const char *format, void *locale,
                            va_list values);
int snprintf(char *buffer, size_t size, const char *format, ...);
void sincos(double x, double *sine, double *cosine);

int snprintf(char *buffer, size_t size, const char *format, ...)
{
    va_list values;
    va_start(values, format);
    const int length =
        __stdio_common_vsprintf(2 /* option: return value as in C99 */, buffer, size, format, NULL, values);
    va_end(values);
    return length;
}

/* Sine and cosine, which the compiler merges into a call of this function. The argument of the cosine is volatile: else
 * the compiler would replace the two calls here by a call of this function itself. */
void sincos(double x, double *sine, double *cosine)
{
    const volatile double copy = x;
    *sine = sin(x);
    *cosine = cos(copy);
}
