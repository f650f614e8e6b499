/* What a host has on Windows beside the system's C runtime: its start, and the functions that are only inside
 * Microsoft's headers. So linked it needs nothing of mingw's runtime, which zig would compile at first; nor
 * stack probes, as no function needs a page of stack. */
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>

enum { AS_C99_HAS_IT = 2 };

int main(int argc, char **argv);
int _configure_narrow_argv(int mode);
void mainCRTStartup(void);
void __main(void);

/* The compiler calls it first: constructors, of which there are none. */
void __main(void)
{
}

void mainCRTStartup(void)
{
    _configure_narrow_argv(1);
    exit(main(*__p___argc(), *__p___argv()));
}

int vsnprintf(char *buffer, size_t size, const char *format, va_list values)
{
    return __stdio_common_vsprintf(AS_C99_HAS_IT, buffer, size, format, NULL, values);
}

int snprintf(char *buffer, size_t size, const char *format, ...)
{
    va_list values;
    va_start(values, format);
    const int length = vsnprintf(buffer, size, format, values);
    va_end(values);
    return length;
}

int fprintf(FILE *file, const char *format, ...)
{
    va_list values;
    va_start(values, format);
    const int length = __stdio_common_vfprintf(AS_C99_HAS_IT, file, format, NULL, values);
    va_end(values);
    return length;
}

int printf(const char *format, ...)
{
    va_list values;
    va_start(values, format);
    const int length = __stdio_common_vfprintf(AS_C99_HAS_IT, stdout, format, NULL, values);
    va_end(values);
    return length;
}

int scanf(const char *format, ...)
{
    va_list values;
    va_start(values, format);
    const int read = __stdio_common_vfscanf(AS_C99_HAS_IT, stdin, format, NULL, values);
    va_end(values);
    return read;
}
