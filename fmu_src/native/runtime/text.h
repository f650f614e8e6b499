/* One line of text, built from pieces without allocation and independent of the locale. */
#ifndef JOINTFMU_TEXT_H
#define JOINTFMU_TEXT_H

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
/* A string of the host in quotation marks: its first 80 bytes, what is not printable ASCII as '?'. */
void text_quote(Text *text, const char *piece);
/* A number with so many significant digits, as "%.{digits}g" prints it in the C locale. */
void text_number(Text *text, double value, int digits);
void text_count(Text *text, size_t count);

#endif
