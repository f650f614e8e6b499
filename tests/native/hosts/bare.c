/* What a host has on Linux for aarch64 without a C library, which zig would take a minute to compile: its start,
 * input and output, memory, and the functions of the C library that a run of an FMU calls. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SYS_READ = 63, SYS_WRITE = 64, SYS_EXIT = 93, MEMORY = 1 << 26, BUFFER = 1 << 16 };

int main(int argc, char **argv);
void start(long *stack);

__asm__(".global _start\n_start:\n mov x0, sp\n and x1, x0, -16\n mov sp, x1\n bl start\n");

static long call(long number, long a, const void *b, size_t c)
{
    register long x8 __asm__("x8") = number;
    register long x0 __asm__("x0") = a;
    register long x1 __asm__("x1") = (long)b;
    register long x2 __asm__("x2") = (long)c;
    __asm__ volatile("svc 0" : "+r"(x0) : "r"(x8), "r"(x1), "r"(x2) : "memory");
    return x0;
}

volatile int not_zero = 1; /* QEMU before 5 cannot load a segment that has zeros alone */
static unsigned char written[BUFFER], given[BUFFER];
static size_t n_written, n_given, n_taken;

static void flush(void)
{
    call(SYS_WRITE, 1, written, n_written);
    n_written = 0;
}

int putchar(int c)
{
    if (n_written == BUFFER)
        flush();
    written[n_written++] = (unsigned char)c;
    return c;
}

int getchar(void)
{
    if (n_taken == n_given) {
        const long n = call(SYS_READ, 0, given, BUFFER);
        if (n <= 0)
            return EOF;
        n_given = (size_t)n;
        n_taken = 0;
    }
    return given[n_taken++];
}

_Noreturn void exit(int status)
{
    flush();
    call(SYS_EXIT, status, NULL, 0);
    __builtin_unreachable();
}

void start(long *stack)
{
    exit(not_zero ? main((int)*stack, (char **)(stack + 1)) : 1);
}

/* Formats have no values but %s and %d. */
int fprintf(FILE *file, const char *format, ...)
{
    va_list values;
    (void)file;
    va_start(values, format);
    for (; *format; format++) {
        if (format[0] == '%' && format[1] == 's') {
            const char *text = va_arg(values, const char *);
            call(SYS_WRITE, 2, text, strlen(text));
            format++;
        } else if (format[0] == '%' && format[1] == 'd') {
            char digits[] = "000000";
            int number = va_arg(values, int);
            for (int i = 5; i >= 0; number /= 10)
                digits[i--] += (char)(number % 10);
            call(SYS_WRITE, 2, digits, strlen(digits));
            format++;
        } else
            call(SYS_WRITE, 2, format, 1);
    }
    va_end(values);
    return 0;
}

/* Messages are their formats, without the values. */
static int put_format(char *buffer, size_t size, const char *format)
{
    const size_t length = strlen(format), n = length < size ? length : size - 1;
    if (size) {
        memcpy(buffer, format, n);
        buffer[n] = '\0';
    }
    return (int)length;
}

int vsnprintf(char *buffer, size_t size, const char *format, va_list values)
{
    (void)values;
    return put_format(buffer, size, format);
}

int snprintf(char *buffer, size_t size, const char *format, ...)
{
    return put_format(buffer, size, format);
}

#undef stderr
FILE *const stderr = NULL;

unsigned long strtoul(const char *restrict text, char **restrict end, int base)
{
    unsigned long number = 0;
    (void)end;
    while (*text)
        number = number * (unsigned long)base + (unsigned long)(*text++ - '0');
    return number;
}

int atoi(const char *text)
{
    return (int)strtoul(text, NULL, 10);
}

/* Nothing is freed. */
void *calloc(size_t count, size_t size)
{
    static unsigned char memory[MEMORY] __attribute__((aligned(16)));
    static size_t used;
    const size_t bytes = (count * size + 15) & ~(size_t)15;
    if (bytes > MEMORY - used)
        return NULL;
    used += bytes;
    return memory + used - bytes;
}

void free(void *pointer)
{
    (void)pointer;
}

/* Bytes are volatile below: the compiler would make a call of the same function of each loop. */
typedef volatile unsigned char Byte;

void *memcpy(void *restrict to, const void *restrict from, size_t n)
{
    for (size_t i = 0; i < n; i++)
        ((Byte *)to)[i] = ((const Byte *)from)[i];
    return to;
}

void *memmove(void *to, const void *from, size_t n)
{
    if ((uintptr_t)to <= (uintptr_t)from)
        return memcpy(to, from, n);
    for (size_t i = n; i-- > 0;)
        ((Byte *)to)[i] = ((const Byte *)from)[i];
    return to;
}

void *memset(void *to, int byte, size_t n)
{
    for (size_t i = 0; i < n; i++)
        ((Byte *)to)[i] = (unsigned char)byte;
    return to;
}

int memcmp(const void *a, const void *b, size_t n)
{
    const Byte *one = a, *other = b;
    for (size_t i = 0; i < n; i++)
        if (one[i] != other[i])
            return one[i] - other[i];
    return 0;
}

int bcmp(const void *a, const void *b, size_t n)
{
    return memcmp(a, b, n);
}

void *memchr(const void *text, int c, size_t n)
{
    for (const Byte *at = text; n-- > 0; at++)
        if (*at == (unsigned char)c)
            return (void *)(uintptr_t)at;
    return NULL;
}

size_t strlen(const char *text)
{
    size_t n = 0;
    while (((const Byte *)text)[n])
        n++;
    return n;
}

int strcmp(const char *a, const char *b)
{
    while (*a && *a == *b)
        a++, b++;
    return (unsigned char)*a - (unsigned char)*b;
}

char *strchr(const char *text, int c)
{
    for (; *text != (char)c; text++)
        if (!*text)
            return NULL;
    return (char *)(uintptr_t)text;
}

double fmax(double x, double y)
{
    return x != x || x < y ? y : x;
}

double fmin(double x, double y)
{
    return x != x || y < x ? y : x;
}

/* Of what is not finite and above zero, which is all that FMUs ask the C library for. */
double pow(double x, double y)
{
    if (x == 1.0 || y == 0.0)
        return 1.0;
    if (x != x || y != y)
        return x + y;
    if (x < 0.0)
        return __builtin_nan("");
    return (x > 1.0) == (y > 0.0) ? __builtin_inf() : 0.0;
}
