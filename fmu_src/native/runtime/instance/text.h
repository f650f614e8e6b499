/* One line of text, built from pieces without allocation and independent of the locale. */
#ifndef JOINTFMU_TEXT_H
#define JOINTFMU_TEXT_H

#include <stdarg.h>
#include <stddef.h>

typedef struct {
    char line[768]; /* zero-terminated; what does not fit is left out */
    size_t length;
} Text;

static inline void text_clear(Text *text)
{
    text->line[0] = '\0';
    text->length = 0;
}
void text_add(Text *text, const char *piece);
/* A number with so many significant digits, as "%.{digits}g" prints it in the C locale. */
void text_number(Text *text, double value, int digits);
/* Pieces as printf has them: %s, %zu, %g and %.3g, and %q for a string of the host in quotation marks: its first
 * 80 bytes, what is not printable ASCII as '?'. */
void text_print(Text *text, const char *format, ...);
void text_print_list(Text *text, const char *format, va_list values);
/* "NAME = VALUE UNIT" */
void text_quantity(Text *text, const char *name, double value, int digits, const char *unit);

#endif
