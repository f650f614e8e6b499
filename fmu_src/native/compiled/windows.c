/* What the Windows library needs beside the system's C runtime, which has snprintf only inside Microsoft's
 * headers. */
#include <math.h>
#include <stdarg.h>
#include <stddef.h>

int __stdio_common_vsprintf(unsigned long long options, char *buffer, size_t size, const char *format,
                            void *locale, va_list values);
int snprintf(char *buffer, size_t size, const char *format, ...);
void sincos(double x, double *sine, double *cosine);

int snprintf(char *buffer, size_t size, const char *format, ...)
{
    va_list values;
    va_start(values, format);
    const int length = __stdio_common_vsprintf(2 /* as C99 has it */, buffer, size, format, NULL, values);
    va_end(values);
    return length;
}

/* sin and cos at once, which the compiler expects and the system does not have. The second argument is read
 * again, as the two calls would be made one of this function. */
void sincos(double x, double *sine, double *cosine)
{
    const volatile double again = x;
    *sine = sin(x);
    *cosine = cos(again);
}
