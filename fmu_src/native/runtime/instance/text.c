#include "text.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "cold.h"

COLD

static void add(Text *text, const char *piece, size_t n)
{
    const size_t room = sizeof text->line - 1 - text->length;
    if (n > room)
        for (n = room; n > 0 && ((unsigned char)piece[n] & 0xC0u) == 0x80u; n--)
            ; /* do not cut a UTF-8 character in two */
    memcpy(text->line + text->length, piece, n);
    text->line[text->length + n] = '\0';
    text->length += n;
}

void text_add(Text *text, const char *piece)
{
    add(text, piece, strlen(piece));
}

static void quote(Text *text, const char *piece)
{
    enum { SHOWN = 80 };
    if (!piece) {
        text_add(text, "NULL");
        return;
    }
    char shown[SHOWN];
    size_t n = 0;
    for (; n < SHOWN && piece[n]; n++)
        shown[n] = piece[n] >= ' ' && piece[n] <= '~' ? piece[n] : '?';
    text_add(text, "'");
    add(text, shown, n);
    text_add(text, n == SHOWN && piece[n] ? "...'" : "'");
}

void text_number(Text *text, double value, int digits)
{
    if (!isfinite(value)) {
        text_add(text, isnan(value) ? "nan" : value > 0.0 ? "inf" : "-inf");
        return;
    }
    char printed[64], plain[64];
    snprintf(printed, sizeof printed, "%.*g", digits, value);
    size_t n = 0;
    for (const char *c = printed; *c; c++) {
        if (strchr("0123456789+-e", *c))
            plain[n++] = *c;
        else if (n == 0 || plain[n - 1] != '.')
            plain[n++] = '.'; /* the locale's decimal sign, of one byte or more */
    }
    add(text, plain, n);
}

void text_print_list(Text *text, const char *format, va_list values)
{
    for (;;) {
        const char *next = strchr(format, '%');
        if (!next) {
            text_add(text, format);
            return;
        }
        add(text, format, (size_t)(next - format));
        format = next + 1;
        int digits = 0;
        for (; *format == '.' || (*format >= '0' && *format <= '9'); format++)
            digits = *format == '.' ? 0 : 10 * digits + (*format - '0');
        const char what = *format++;
        if (what == 's')
            text_add(text, va_arg(values, const char *));
        else if (what == 'q')
            quote(text, va_arg(values, const char *));
        else if (what == 'g')
            text_number(text, va_arg(values, double), digits ? digits : 6);
        else { /* zu */
            char count[32];
            format++;
            snprintf(count, sizeof count, "%zu", va_arg(values, size_t));
            text_add(text, count);
        }
    }
}

void text_print(Text *text, const char *format, ...)
{
    va_list values;
    va_start(values, format);
    text_print_list(text, format, values);
    va_end(values);
}

void text_quantity(Text *text, const char *name, double value, int digits, const char *unit)
{
    text_print(text, "%s = ", name);
    text_number(text, value, digits);
    text_print(text, unit[0] ? " %s" : "", unit);
}

END_OF_COLD
