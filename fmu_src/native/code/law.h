#ifndef JOINTFMU_LAW_H
#define JOINTFMU_LAW_H

#include <math.h>

#include "elementary.h"

enum {
{% for name, value in counts.items() %}
    {{ name }} = {{ value }},
{% endfor %}
};

{% for name, value in macros.items() %}
#define {{ name }} {{ value }}
{% endfor %}
{% if tabulated %}

/* An interval of a parameter that other parameters decide. */
typedef struct {
    int parameter; /* its place in the list of parameters */
    unsigned char low_open, high_open;
    const char *doc;
} Limit;
extern const Limit limits[{{ [counts.N_LIMITS, 1] | max }}];

/* A way to leave the tables: an input or output outside its interval. */
typedef struct {
    int variable; /* its place in the list of inputs and outputs */
    const char *doc;
} Warning;
{{ warnings }}
{% endif %}
{% for name in arrays %}
extern const double {{ name }};
{% endfor %}

/* y = name(x); c are the constants: parameters, fixed ones, then what law_constants computes. */
{% for name in prototypes %}
void {{ name }}(const double *x, const double *c, double *y);
{% endfor %}
{% if series %}
typedef void Law(const double *x, const double *c, double *y);
{% endif %}
{% for name in series %}
extern Law *const {{ name }}[N_LAW_SWITCHES + 1];
{% endfor %}

{{ helpers }}
{% for text in inline %}
{{ text }}
{% endfor %}
#endif
