/* One line of text, assembled without allocation and independent of the locale. */
#ifndef JOINTFMU_TEXT_H
#define JOINTFMU_TEXT_H

#include <stdarg.h>
#include <stddef.h>

typedef struct {
    char line[768]; /* zero-terminated; text that does not fit is dropped */
    size_t length;
} Text;

static inline void text_clear(Text *text)
{
    text->line[0] = '\0';
    text->length = 0;
}
void text_append(Text *text, const char *piece);
/* Append a number with `digits` significant digits, as "%.{digits}g" prints it in the C locale. */
void text_append_number(Text *text, double value, int digits);
/* Append formatted text, as printf: %s, %zu, %g and %.3g; and %q for a string of the host in quotation marks: its first
 * 80 bytes, with '?' for a byte that is not printable ASCII. */
void text_append_format(Text *text, const char *format, ...);
void text_append_format_list(Text *text, const char *format, va_list values);
/* Append "NAME = VALUE UNIT". */
void text_append_quantity(Text *text, const char *name, double value, int digits, const char *unit);

#endif
