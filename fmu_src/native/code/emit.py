"""C code from CasADi expressions: one C function (x, c) -> y for each function of a graph.

Elementary functions are those of `law/elementary.c`, which give the same bits on every platform.
"""

import re
from collections import Counter
from collections.abc import Mapping, Sequence

import casadi as ca

_BINARY_OPERATION_C_FORMATS = {
    ca.OP_ADD: "{0} + {1}",
    ca.OP_SUB: "{0} - {1}",
    ca.OP_MUL: "{0} * {1}",
    ca.OP_DIV: "{0} / {1}",
    ca.OP_POW: "portable_pow({0}, {1})",
    ca.OP_CONSTPOW: "portable_pow({0}, {1})",
    ca.OP_LT: "{0} < {1} ? 1.0 : 0.0",
    ca.OP_LE: "{0} <= {1} ? 1.0 : 0.0",
    ca.OP_EQ: "{0} == {1} ? 1.0 : 0.0",
    ca.OP_NE: "{0} != {1} ? 1.0 : 0.0",
    ca.OP_AND: "{0} != 0.0 && {1} != 0.0 ? 1.0 : 0.0",
    ca.OP_OR: "{0} != 0.0 || {1} != 0.0 ? 1.0 : 0.0",
    ca.OP_IF_ELSE_ZERO: "{0} != 0.0 ? {1} : 0.0",
    ca.OP_FMIN: "{0} < {1} ? {0} : {1}",
    ca.OP_FMAX: "{0} > {1} ? {0} : {1}",
    ca.OP_ATAN2: "atan2({0}, {1})",
    ca.OP_HYPOT: "scaled_hypot({0}, {1})",
    ca.OP_COPYSIGN: "copysign({0}, {1})",
}
"""{CasADi operation with two operands: C expression}."""
_UNARY_OPERATION_C_FORMATS = {
    ca.OP_ASSIGN: "{0}",
    ca.OP_NEG: "-{0}",
    ca.OP_SQ: "{0} * {0}",
    ca.OP_TWICE: "2.0 * {0}",
    ca.OP_INV: "1.0 / {0}",
    ca.OP_SQRT: "sqrt({0})",
    ca.OP_EXP: "portable_exp({0})",
    ca.OP_LOG: "portable_log({0})",
    ca.OP_EXPM1: "fast_expm1({0})",
    ca.OP_LOG1P: "portable_log1p({0})",
    ca.OP_SIN: "portable_sin({0})",
    ca.OP_COS: "portable_cos({0})",
    ca.OP_TAN: "tan({0})",
    ca.OP_ASIN: "asin({0})",
    ca.OP_ACOS: "acos({0})",
    ca.OP_ATAN: "atan({0})",
    ca.OP_TANH: "portable_tanh({0})",
    ca.OP_ERF: "portable_erf({0})",
    ca.OP_FABS: "fabs({0})",
    ca.OP_FLOOR: "floor({0})",
    ca.OP_NOT: "{0} == 0.0 ? 1.0 : 0.0",
    ca.OP_SIGN: "{0} > 0.0 ? 1.0 : ({0} < 0.0 ? -1.0 : {0})",
}
"""{CasADi operation with one operand: C expression}."""

_DERIVATIVE_OPERATION_C_FORMATS = {
    ca.OP_DIV: "{0} == 0.0 ? 0.0 : {0} / {1}",
    ca.OP_SIGN: "({0} > 0.0 ? 1.0 : 0.0) - ({0} < 0.0 ? 1.0 : 0.0)",
}
"""{CasADi operation: C expression} that differ in directional derivatives, see `format_function`."""

C_HELPER_FUNCTIONS = """/* exp(x) - 1; where the difference does not cancel by the faster exponential. */
static inline double fast_expm1(double x)
{
    return x < -0.7 || x > 0.7 ? portable_exp(x) - 1.0 : portable_expm1(x);
}

/* sqrt(a^2 + b^2); very large or small numbers are scaled so that the squares do not over- or underflow. */
static inline double scaled_hypot(double a, double b)
{
    const double sum = a * a + b * b;
    if (sum > 1e-280 && sum < 1e280)
        return sqrt(sum);
    const double scale = sum < 1.0 ? 0x1p600 : 0x1p-600, x = scale * a, y = scale * b;
    return sqrt(x * x + y * y) / scale;
}
"""
"""C helper functions that the generated functions call, besides libm and `law/elementary.c`."""


def format_function(
    function_name: str,
    signature_comment: str,
    argument_symbols: ca.SX,
    constant_symbols: ca.SX,
    result_expressions: Sequence[ca.SX],
    is_derivative: bool = False,
    has_workspace: bool = False,
    leading_result_count: int | None = None,
) -> str:
    """Format a C function `void name(const double *x, const double *c, double *y)` from CasADi expressions.

    Every intermediate value becomes a local constant in C, in the order of evaluation. Repeated divisions by
    the same number become products with its reciprocal, except in a derivative.

    argument_symbols     : symbols of the arguments x
    constant_symbols     : symbols of the constants c of an FMU
    result_expressions   : results y
    is_derivative        : whether y is a directional derivative. Then 0/0 is 0, so that a zero seed gives
        zero even at an infinite slope; and min or max of two equal values has the derivative of the first.
    has_workspace        : whether intermediate values are stored in the array y behind the results, not on
        the stack
    leading_result_count : number of leading results that the function can compute alone. The function then
        has an argument `size_t n` before y, the number of leading results to compute. None: always all
    """
    graph = ca.Function(
        "f",
        [argument_symbols, constant_symbols],
        [ca.vertcat(*(ca.SX(value) for value in result_expressions))],
    )
    inputs = "xc"
    names_of_values: dict[int, str] = {}
    body: list[str] = []
    used_inputs: set[str] = set()
    operations: dict[str, tuple[int, list[str]]] = {}
    for k in range(graph.n_instructions()):
        code, out, args = graph.instruction_id(k), graph.instruction_output(k), graph.instruction_input(k)
        if code == ca.OP_OUTPUT:
            body.append(f"y[{out[1]}] = {names_of_values[args[0]]};")
        elif code == ca.OP_CONST:
            names_of_values[out[0]] = _format_c_number(graph.instruction_constant(k))
        elif code == ca.OP_INPUT:
            used_inputs.add(inputs[args[0]])
            names_of_values[out[0]] = f"{inputs[args[0]]}[{args[1]}]"
        else:
            form = _BINARY_OPERATION_C_FORMATS.get(code) or _UNARY_OPERATION_C_FORMATS.get(code)
            if is_derivative:
                form = _DERIVATIVE_OPERATION_C_FORMATS.get(code, form)
            if form is None:
                raise NotImplementedError(
                    f"{function_name}: no C code is known for operation {code} of CasADi"
                )
            names = [names_of_values[a] for a in args]
            simpler = (
                _C_SIMPLIFICATION_FUNCTIONS[code](names, operations)
                if code in _C_SIMPLIFICATION_FUNCTIONS
                else None
            )
            body.append(f"const double t{k} = {simpler or form.format(*names)};")
            names_of_values[out[0]] = f"t{k}"
            operations[f"t{k}"] = (ca.OP_LE if code == ca.OP_DIV and simpler else code), names
    unused = [name for name in inputs if name not in used_inputs] + ([] if result_expressions else ["y"])
    body += [f"(void){name};" for name in unused]
    if leading_result_count is not None:
        body = _return_after_leading_results(body, leading_result_count)
    used_lines = _place_sine_and_cosine_together(_move_calls_into_conditions(_drop_unused_lines(body)))
    code_lines = used_lines if is_derivative else _replace_repeated_divisions(used_lines)
    if has_workspace:
        first = f"double *const w = y + {len(result_expressions)}; /* intermediate values */"
        code_lines = [first, *_move_values_to_workspace(code_lines)]
    lines = "\n".join(f"    {line}" for line in _call_sine_cosine_pairs_once(code_lines))
    count_argument = "" if leading_result_count is None else "size_t n, "
    head = f"void {function_name}(const double *x, const double *c, {count_argument}double *y)"
    return f"/* {signature_comment} */\n{head}\n{{\n{lines}\n}}\n"


def count_workspace_values(function_text: str) -> int:
    """Count the intermediate values that a generated C function stores in its array y after the results."""
    return max((int(index) + 1 for index in re.findall(r"\bw\[(\d+)\]", function_text)), default=0)


def _move_values_to_workspace(code_lines: Sequence[str]) -> list[str]:
    """Replace local constants of generated C by entries of the array w, which several constants share."""
    last_use = {
        name: i for i, line in enumerate(code_lines) for name in _INTERMEDIATE_VALUE_PATTERN.findall(line)
    }
    slots, free_slots, lines = dict[str, int](), list[int](), list[str]()
    for i, line in enumerate(code_lines):
        name, _, expression = line.removeprefix("const double ").partition(" = ")
        expression = _INTERMEDIATE_VALUE_PATTERN.sub(lambda match: f"w[{slots[match[0]]}]", expression)
        free_slots += [slots.pop(used) for used in [*slots] if last_use[used] == i]
        if line.startswith("const "):
            slots[name] = free_slots.pop() if free_slots else len(slots)
            name = f"w[{slots[name]}]"
        lines.append(f"{name} = {expression}" if expression else line)
    return lines


_INTERMEDIATE_VALUE_PATTERN = re.compile(r"\b(?:per_)?t\d+\b")
"""Pattern of the name of an intermediate value in generated C."""
_OperationsByName = Mapping[str, tuple[int, list[str]]]
"""{name of a value: (CasADi operation, names of its operands)}."""


def _simplify_quotient(operand_names: Sequence[str], operation_by_name: _OperationsByName) -> str | None:
    """Simpler C expression of (a <= b)/((a <= b) + (b <= a)), CasADi's derivative of min(a, b) or max(a, b).

    CasADi's derivative is 1/2 if a equals b; here the derivative by the first argument is then 1, by the
    second 0. Returns None for another quotient.
    """
    numerator, denominator = operand_names
    code, terms = operation_by_name.get(denominator, (None, [""]))
    if code != ca.OP_ADD or numerator not in terms:
        return None
    first = terms[0]
    (first_code, ends), (second_code, others) = (operation_by_name.get(name, (None, [])) for name in terms)
    if (first_code, second_code) != (ca.OP_LE, ca.OP_LE) or ends != others[::-1]:
        return None
    return first if numerator == first else f"{first} == 0.0 ? 1.0 : 0.0"


def _simplify_product(operand_names: Sequence[str], operation_by_name: _OperationsByName) -> str | None:
    """C conditional expression for the product of a value and a condition (1 or 0).

    Returns None for another product.
    """
    for condition, value in (operand_names, operand_names[::-1]):
        if operation_by_name.get(condition, (None, []))[0] in _CONDITION_CASADI_OPERATIONS:
            return f"{condition} != 0.0 ? {value} : 0.0"
    return None


def _simplify_sum(operand_names: Sequence[str], operation_by_name: _OperationsByName) -> str | None:
    """C conditional expression for CasADi's form of `condition ? a : b`: a sum with one term equal to 0.

    Returns None for another sum.
    """
    (code, first), (other, second) = (operation_by_name.get(name, (None, [])) for name in operand_names)
    if code != ca.OP_IF_ELSE_ZERO or other != ca.OP_IF_ELSE_ZERO:
        return None
    for (yes, a), (no, b) in ((first, second), (second, first)):
        if operation_by_name.get(no) == (ca.OP_NOT, [yes]):
            return f"{yes} != 0.0 ? {a} : {b}"
    return None


_C_SIMPLIFICATION_FUNCTIONS = {
    ca.OP_ADD: _simplify_sum,
    ca.OP_DIV: _simplify_quotient,
    ca.OP_MUL: _simplify_product,
}
"""{CasADi operation: function that finds a simpler C expression}."""
_CONDITION_CASADI_OPERATIONS = (ca.OP_LT, ca.OP_LE, ca.OP_EQ, ca.OP_NE, ca.OP_AND, ca.OP_OR, ca.OP_NOT)
"""CasADi operations whose result is a condition, 1 or 0."""


def _drop_unused_lines(code_lines: Sequence[str]) -> list[str]:
    """Remove lines of generated C whose value no later line uses."""
    lines, used_values = list[str](), set[str]()
    for line in reversed(code_lines):
        name, _, value = line.removeprefix("const double ").partition(" = ")
        if line.startswith("const ") and name not in used_values:
            continue
        used_values.update(re.findall(r"\bt\d+\b", value))
        lines.append(line)
    return lines[::-1]


def _return_after_leading_results(code_lines: Sequence[str], leading_result_count: int) -> list[str]:
    """Move the lines for the leading results to the front of a C function, with a return behind them.

    The function returns there if its argument n asks for no further results.
    """
    needed = {f"y[{k}]" for k in range(leading_result_count)}
    leading_lines, other_lines = list[str](), list[str]()
    for line in reversed(code_lines):
        name, _, value = line.removeprefix("const double ").partition(" = ")
        if name in needed:
            needed.update(_INTERMEDIATE_VALUE_PATTERN.findall(value))
        (leading_lines if name in needed else other_lines).append(line)
    condition = f"if (n <= {leading_result_count})\n        return;" if other_lines else "(void)n;"
    return [*leading_lines[::-1], condition, *other_lines[::-1]]


_ELEMENTARY_CALL_PATTERN = re.compile(r"const double (t\d+) = (portable_\w+\(.*\));")
"""Pattern of a line of generated C that calls an elementary function: result, call."""
_CONDITIONAL_BRANCH_PATTERN = re.compile(r"(?<=[?:] )t\d+(?= :|;)")
"""Pattern of a value that is a branch of a conditional expression in generated C."""


def _move_calls_into_conditions(code_lines: Sequence[str]) -> list[str]:
    """Move a call of an elementary function into the conditional expression that alone uses its result.

    The function is then evaluated only if the condition holds.
    """
    uses = Counter(
        name for line in code_lines for name in _INTERMEDIATE_VALUE_PATTERN.findall(line.partition(" = ")[2])
    )
    branches = {
        name for line in code_lines for name in _CONDITIONAL_BRANCH_PATTERN.findall(line) if uses[name] == 1
    }
    lines, calls = list[str](), dict[str, str]()
    for line in code_lines:
        call = _ELEMENTARY_CALL_PATTERN.fullmatch(line)
        if call and call[1] in branches:
            calls[call[1]] = call[2]
        else:
            lines.append(_CONDITIONAL_BRANCH_PATTERN.sub(lambda match: calls.get(match[0], match[0]), line))
    return lines


_SINE_OR_COSINE_LINE_PATTERN = re.compile(r"(const double )?(\S+) = portable_(sin|cos)\((\S+)\);")
"""Pattern of a line of generated C with a sine or cosine: declaration, result, function, angle."""


def _place_sine_and_cosine_together(code_lines: Sequence[str]) -> list[str]:
    """Make the lines of generated C with sine and cosine of the same angle adjacent: the later line moves."""
    matches = [_SINE_OR_COSINE_LINE_PATTERN.fullmatch(line) for line in code_lines]
    lines_by_angle: dict[str, list[str]] = {}
    for line, match in zip(code_lines, matches, strict=True):
        if match:
            lines_by_angle.setdefault(match[4], []).append(line)
    lines = list[str]()
    for line, match in zip(code_lines, matches, strict=True):
        lines += lines_by_angle.pop(match[4], []) if match else [line]
    return lines


def _call_sine_cosine_pairs_once(code_lines: Sequence[str]) -> list[str]:
    """Replace adjacent lines of generated C with sine and cosine of an angle by one call for both."""
    lines, previous = list[str](), None
    for line in code_lines:
        match = _SINE_OR_COSINE_LINE_PATTERN.fullmatch(line)
        if match and previous and match[4] == previous[4]:
            sine, cosine = (previous, match) if match[3] == "cos" else (match, previous)
            declarations = [f"double {cosine[2]};"] if cosine[1] else []
            call = f"{sine[1] or ''}{sine[2]} = portable_sin_cos({sine[4]}, &{cosine[2]});"
            lines[-1:] = [*declarations, call]
            previous = None
        else:
            lines.append(line)
            previous = match
    return lines


_DIVISION_LINE_PATTERN = re.compile(r"const double (t\d+) = (\S+) / (t\d+|x\[\d+\]);")
"""Pattern of a line of generated C that divides: result, dividend, divisor."""


def _replace_repeated_divisions(code_lines: Sequence[str]) -> list[str]:
    """Replace several divisions by the same number in generated C by one reciprocal and products."""
    divisions = [_DIVISION_LINE_PATTERN.fullmatch(line) for line in code_lines]
    count = Counter(match[3] for match in divisions if match)
    lines, reciprocals = list[str](), dict[str, str]()
    for line, match in zip(code_lines, divisions, strict=True):
        if match and count[match[3]] > 1:
            name, numerator, divisor = match.groups()
            if divisor not in reciprocals:
                reciprocals[divisor] = f"per_{name}"
                lines.append(f"const double per_{name} = 1.0 / {divisor};")
            line = f"const double {name} = {numerator} * {reciprocals[divisor]};"
        lines.append(line)
    return lines


def _format_c_number(real_number: float) -> str:
    """C literal of a number; negative numbers are in parentheses."""
    if real_number != real_number or real_number in (float("inf"), float("-inf")):
        return {"inf": "INFINITY", "-inf": "-INFINITY"}.get(repr(real_number), "NAN")
    return f"({real_number!r})" if real_number < 0 else repr(real_number)
