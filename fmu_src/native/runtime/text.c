#include "text.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

void text_add(Text *text, const char *piece)
{
    const size_t room = sizeof text->line - 1 - text->length;
    size_t n = strlen(piece);
    if (n > room)
        for (n = room; n > 0 && ((unsigned char)piece[n] & 0xC0u) == 0x80u; n--)
            ; /* do not cut a UTF-8 character in two */
    memcpy(text->line + text->length, piece, n);
    text->line[text->length + n] = '\0';
    text->length += n;
}

void text_quote(Text *text, const char *piece)
{
    enum { SHOWN = 80 };
    if (!piece) {
        text_add(text, "NULL");
        return;
    }
    char shown[SHOWN + 1];
    size_t n = 0;
    for (; n < SHOWN && piece[n]; n++)
        shown[n] = piece[n] >= ' ' && piece[n] <= '~' ? piece[n] : '?';
    shown[n] = '\0';
    text_add(text, "'");
    text_add(text, shown);
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
    plain[n] = '\0';
    text_add(text, plain);
}

void text_count(Text *text, size_t count)
{
    char printed[32];
    snprintf(printed, sizeof printed, "%zu", count);
    text_add(text, printed);
}
