#ifndef JOINTFMU_LAW_H
#define JOINTFMU_LAW_H

#include <math.h>
#include <stddef.h>

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

/* Parameter whose interval depends on other parameters; `parameter_limit_bounds` computes the interval. */
typedef struct {
    int parameter;                     /* index in the list of parameters */
    unsigned char low_open, high_open; /* 1: the bound itself is not allowed */
    const char *doc;
} ParameterLimit;
extern const ParameterLimit limited_parameters[{{ [counts.N_PARAMETER_LIMITS, 1] | max }}];

/* Input or output with a range of validity; `validity_bounds` computes the range. Outside of it a warning is logged. */
typedef struct {
    int variable; /* index in the list of inputs and outputs */
    const char *doc;
} ValidityLimit;
{{ validity_limits }}
{% endif %}
{% for name in arrays %}
extern const double {{ name }};
{% endfor %}

/* Each function computes y from the arguments x. c are the constants of the joint: parameters, parameters that are not
 * FMU variables, then the expressions of both that `law_constants` computes. A function with the argument n may leave
 * out the results from y[n] on. */
{% for prototype in prototypes %}
{{ prototype }};
{% endfor %}
{% if series %}
typedef void LawFunction(const double *x, const double *c, double *y);
{% endif %}
{% for name in series %}
extern LawFunction *const {{ name }}[N_LAW_RANGE_BOUNDS + 1]; /* one for each range of log-areas */
{% endfor %}

{{ helpers }}
{% for text in inline %}
{{ text }}
{% endfor %}
#endif
