/* snprintf for the Windows library: the system's C runtime has it only inside Microsoft's headers. */
#include <stdarg.h>
#include <stddef.h>

int __stdio_common_vsprintf(unsigned long long options, char *buffer, size_t size, const char *format,
                            void *locale, va_list values);
int snprintf(char *buffer, size_t size, const char *format, ...);

int snprintf(char *buffer, size_t size, const char *format, ...)
{
    va_list values;
    va_start(values, format);
    const int length = __stdio_common_vsprintf(2 /* as C99 has it */, buffer, size, format, NULL, values);
    va_end(values);
    return length;
}
