#include "text.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "optimize_for_size.h"

OPTIMIZE_FOR_SIZE

/* Append n bytes, as far as they fit. */
static void append(Text *text, const char *piece, size_t n)
{
    const size_t remaining = sizeof text->line - 1 - text->length;
    if (n > remaining)
        for (n = remaining; n > 0 && ((unsigned char)piece[n] & 0xC0u) == 0x80u; n--)
            ; /* do not split a UTF-8 character */
    memcpy(text->line + text->length, piece, n);
    text->line[text->length + n] = '\0';
    text->length += n;
}

void text_append(Text *text, const char *piece)
{
    append(text, piece, strlen(piece));
}

/* Append a string of the host in quotation marks, without characters that are not printable ASCII. */
static void append_quoted(Text *text, const char *piece)
{
    enum { MAX_QUOTED = 80 };
    if (!piece) {
        text_append(text, "NULL");
        return;
    }
    char quoted[MAX_QUOTED];
    size_t n = 0;
    for (; n < MAX_QUOTED && piece[n]; n++)
        quoted[n] = piece[n] >= ' ' && piece[n] <= '~' ? piece[n] : '?';
    text_append(text, "'");
    append(text, quoted, n);
    text_append(text, n == MAX_QUOTED && piece[n] ? "...'" : "'");
}

void text_append_number(Text *text, double value, int digits)
{
    if (!isfinite(value)) {
        text_append(text, isnan(value) ? "nan" : value > 0.0 ? "inf" : "-inf");
        return;
    }
    char printed[64], with_point[64];
    snprintf(printed, sizeof printed, "%.*g", digits, value);
    size_t n = 0;
    for (const char *c = printed; *c; c++) {
        if (strchr("0123456789+-e", *c))
            with_point[n++] = *c;
        else if (n == 0 || with_point[n - 1] != '.')
            with_point[n++] = '.'; /* decimal separator of the locale, of one or more bytes */
    }
    append(text, with_point, n);
}

void text_append_format_list(Text *text, const char *format, va_list values)
{
    for (;;) {
        const char *percent = strchr(format, '%');
        if (!percent) {
            text_append(text, format);
            return;
        }
        append(text, format, (size_t)(percent - format));
        format = percent + 1;
        int digits = 0;
        for (; *format == '.' || (*format >= '0' && *format <= '9'); format++)
            digits = *format == '.' ? 0 : 10 * digits + (*format - '0');
        const char conversion = *format++;
        if (conversion == 's')
            text_append(text, va_arg(values, const char *));
        else if (conversion == 'q')
            append_quoted(text, va_arg(values, const char *));
        else if (conversion == 'g')
            text_append_number(text, va_arg(values, double), digits ? digits : 6);
        else { /* zu */
            char count[32];
            format++;
            snprintf(count, sizeof count, "%zu", va_arg(values, size_t));
            text_append(text, count);
        }
    }
}

void text_append_format(Text *text, const char *format, ...)
{
    va_list values;
    va_start(values, format);
    text_append_format_list(text, format, values);
    va_end(values);
}

void text_append_quantity(Text *text, const char *name, double value, int digits, const char *unit)
{
    text_append_format(text, "%s = ", name);
    text_append_number(text, value, digits);
    text_append_format(text, unit[0] ? " %s" : "", unit);
}

END_OPTIMIZE_FOR_SIZE
