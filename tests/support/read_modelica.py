"""Equations of a Modelica component as pymoca reads them, evaluated at the solution of another tool.

pymoca cannot simulate models that call functions with matrices, but its parser is independent of rumoca, and
so is the evaluation in this module. If the equations hold along rumoca's solution, rumoca solves the written
equations.
"""

import operator
from collections.abc import Callable, Iterator, Mapping
from functools import reduce
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Env = dict[str, Any]

_SMALL = {"Modelica.Constants.small": 1e-60}
_OPERATORS: dict[str, Callable[[Any, Any], Any]] = {
    "+": operator.add,
    "-": operator.sub,
    "*": operator.mul,
    "/": operator.truediv,
    "^": operator.pow,
    "<": operator.lt,
    ">": operator.gt,
    "<=": operator.le,
    ">=": operator.ge,
    "and": np.logical_and,
    "or": np.logical_or,
}
_FUNCTIONS: dict[str, Callable[..., Any]] = {
    "abs": np.abs,
    "cos": np.cos,
    "exp": np.exp,
    "max": np.maximum,
    "min": np.minimum,
    "noEvent": lambda x: x,
    "sin": np.sin,
    "sqrt": np.sqrt,
    "sum": lambda values: reduce(operator.add, values),
    "tanh": np.tanh,
}


def read(*folders: Path) -> Any:
    """All classes in .mo files of folders, packages before their contents."""
    from pymoca import ast, parser

    root = ast.Tree()
    for folder in folders:
        for path in sorted(folder.rglob("*.mo"), key=lambda p: (len(p.parts) - (p.name == "package.mo"), p)):
            root.extend(parser.parse(path.read_text(encoding="utf-8")))
    return root


class Read:
    """Evaluator of a component's equations with a record `data`, at values of its variables over time.

    Scalars are numbers or arrays over time, Modelica's arrays are lists of them.

    values  : values of all variables that are no parameters
    changes : changed values of parameters
    """

    def __init__(
        self, root: Any, component: str, record: str, time: Array, values: Env, changes: Mapping[str, Any]
    ):
        from pymoca import ast, tree

        self.library = root.classes["JointStiffness"].classes
        own, data = self.library["Components"].classes[component], f"JointStiffness.Data.{record}"
        filled = tree.flatten(root, ast.ComponentRef.from_string(data)).classes[data]
        self.equations = own.equations
        self.given = {name: _binding(s) for name, s in own.symbols.items() if _fixed(s)}
        self.given |= {f"data.{name}": s.value for name, s in filled.symbols.items()}
        self.time, self.values, self.changes = time, {**_SMALL, **values}, changes

    def errors(self) -> dict[str, float]:
        """Largest difference of both sides over the largest value, for each left side: {left side: error}."""
        most: dict[str, float] = {}
        size: dict[str, float] = {}
        with np.errstate(all="ignore"):  # in the branch of a condition that is not taken
            for equation in self.equations:
                for name, left, right in self._sides(equation, {}):
                    sides = [np.stack(side) if isinstance(side, list) else side for side in (left, right)]
                    most[name] = max(most.get(name, 0.0), float(np.max(np.abs(sides[0] - sides[1]))))
                    size[name] = max(size.get(name, 0.0), float(np.max(np.abs(sides[0]))))
        return {name: difference / (size[name] or 1.0) for name, difference in most.items()}

    def _sides(self, equation: Any, local: Env) -> Iterator[tuple[str, Any, Any]]:
        """Name, left and right side of every equation. For x = der(y), both sides are integrated."""
        kind = type(equation).__name__
        if kind == "ForEquation":
            (index,) = equation.indices
            for i in self.value(index.expression, local):
                for inner in equation.equations:
                    yield from self._sides(inner, local | {index.name: i})
        elif kind == "IfEquation":
            chosen = next(
                block
                for condition, block in zip([*equation.conditions, True], equation.blocks, strict=False)
                if self.value(condition, local)
            )
            for inner in chosen:
                yield from self._sides(inner, local)
        elif kind == "Equation":
            left, right = equation.left, equation.right
            if _is_rate(right):
                left, right = right, left
            if _is_rate(left):
                (state,) = left.operands
                yield from self._integrals(state, right, local)
            else:
                yield _name(left), self.value(left, local), self.value(right, local)

    def _integrals(self, state: Any, rate: Any, local: Env) -> Iterator[tuple[str, Any, Any]]:
        """Change of a state, or of a list of states, and the integral of its rate by the trapezoidal rule."""
        states, rates = self.value(state, local), self.value(rate, local)
        if not isinstance(states, list):
            states, rates = [states], [rates]
        for y, x in zip(states, rates, strict=True):
            over = np.broadcast_to(x, self.time.shape)
            steps = 0.5 * (over[1:] + over[:-1]) * np.diff(self.time)
            yield f"der({_name(state)})", y - y[0], np.append(0.0, np.cumsum(steps))

    def value(self, x: Any, local: Env) -> Any:
        kind = type(x).__name__
        if kind == "Primary":
            return x.value
        if kind == "ComponentRef":
            return self._variable(x, local)
        if kind == "Array":
            return [self.value(item, local) for item in x.values]
        if kind == "Slice":
            first, step, last = (int(self.value(item, local)) for item in (x.start, x.step, x.stop))
            return list(range(first, last + 1, step))
        if kind == "IfExpression":
            *cases, otherwise = (self.value(item, local) for item in x.expressions)
            for condition, case in zip(reversed(x.conditions), reversed(cases), strict=True):
                otherwise = np.where(self.value(condition, local), case, otherwise)
            return otherwise
        if kind == "Expression":
            return self._expression(x, local)
        return x  # a Boolean, a number

    def _expression(self, x: Any, local: Env) -> Any:
        name = _operator(x)
        operands = [self.value(item, local) for item in x.operands]
        if name == "size":
            return len(operands[0]) if operands[1] == 1 else len(operands[0][0])
        if name in _FUNCTIONS:
            return _FUNCTIONS[name](*operands)
        if name == "-" and len(operands) == 1:
            return _each(operator.neg, operands[0])
        if name == "not":
            return not operands[0]
        if name in _OPERATORS:
            return _combined(name, *operands)
        return self._call(name.rpartition(".")[2], operands)

    def _call(self, name: str, operands: list[Any]) -> Any:
        """Value of a call of a library function."""
        function = self.library["Functions"].classes[name]
        inputs = [n for n, s in function.symbols.items() if "input" in s.prefixes]
        local: Env = {n: self.value(_binding(s), {}) for n, s in function.symbols.items() if _fixed(s)}
        local |= zip(inputs, operands, strict=True)
        self._run(function.statements, local)
        (output,) = (n for n, s in function.symbols.items() if "output" in s.prefixes)
        return local[output]

    def _run(self, statements: Any, local: Env) -> None:
        for statement in statements:
            if type(statement).__name__ == "ForStatement":
                (index,) = statement.indices
                for i in self.value(index.expression, local):
                    local[index.name] = i
                    self._run(statement.statements, local)
            else:
                (target,) = statement.left
                value, places = self.value(statement.right, local), _indices(target)
                at = [int(self.value(place, local)) - 1 for place in places]
                local[target.name] = _set(local.get(target.name) if at else None, at, value)

    def _variable(self, x: Any, local: Env) -> Any:
        name = _name(x)
        if name in local:
            found = local[name]
        elif name in self.changes:
            found = self.changes[name]
        elif name in self.given:
            found = self.value(self.given[name], {})
        else:
            found = self.values[name]
        return _element(found, [self._index(i, local) for i in _indices(x)])

    def _index(self, i: Any, local: Env) -> Any:
        whole = type(i).__name__ == "Slice" and getattr(i.stop, "value", 1) is None
        return None if whole else self.value(i, local)


def _set(found: Any, at: list[int], value: Any) -> Any:
    """Array with an item set at an index, which may be one after the last."""
    if not at:
        return value
    items = list(found or [])
    here = items[at[0]] if at[0] < len(items) else None
    return [*items[: at[0]], _set(here, at[1:], value), *items[at[0] + 1 :]]


def _binding(symbol: Any) -> Any:
    """Expression to which a declaration binds its variable."""
    changes = symbol.class_modification.arguments if symbol.class_modification else []
    values = [c.value.modifications for c in changes if c.value.component.name == "value"]
    return values[0][0] if values else symbol.value


def _fixed(symbol: Any) -> bool:
    return bool({"parameter", "constant"} & set(symbol.prefixes))


def _operator(x: Any) -> str:
    return x.operator if isinstance(x.operator, str) else _name(x.operator)


def _is_rate(x: Any) -> bool:
    return type(x).__name__ == "Expression" and _operator(x) == "der"


def _name(x: Any) -> str:
    return ".".join([x.name, *map(_name, x.child)])


def _indices(x: Any) -> list[Any]:
    own = [i for level in x.indices for i in level if i is not None]
    return own + [i for child in x.child for i in _indices(child)]


def _element(found: Any, indices: list[Any]) -> Any:
    if not indices:
        return found
    first, *rest = indices
    if first is None:
        return [_element(item, rest) for item in found]
    if np.ndim(first):  # another one at each time
        return np.array([_element(item, rest) for item in found])[np.asarray(first, dtype=int) - 1]
    return _element(found[int(first) - 1], rest)


def _each(function: Callable[[Any], Any], x: Any) -> Any:
    return [_each(function, item) for item in x] if isinstance(x, list) else function(x)


def _combined(name: str, a: Any, b: Any) -> Any:
    """Result of a binary operator; of two lists the product is the scalar product."""
    if isinstance(a, list) and isinstance(b, list):
        items = [_combined(name, x, y) for x, y in zip(a, b, strict=True)]
        return reduce(operator.add, items) if name == "*" else items
    if isinstance(a, list):
        return [_combined(name, x, b) for x in a]
    if isinstance(b, list):
        return [_combined(name, a, y) for y in b]
    return _OPERATORS[name](a, b)


def solution(found: Any, component: str, first: Array) -> Env:
    """Variables of a component in a result, arrays as lists, with the variables of its flanges."""
    out: Env = {}
    for name in found.names:
        own = name.removeprefix(f"{component}.")
        if own != name:
            _put(out, own, np.asarray(found[name])[first])
    return out


def _put(out: Env, name: str, values: Array) -> None:
    """Add a variable to nested lists: q[2,3] becomes the third item of the second list of q."""
    stem, _, rest = name.partition("[")
    if not rest:
        out[name] = values
        return
    *outer, last = (int(i) - 1 for i in rest.rstrip("]").split(","))
    here = out.setdefault(stem, [])
    for i in outer:
        here += [[] for _ in range(i + 1 - len(here))]
        here = here[i]
    here += [None] * (last + 1 - len(here))
    here[last] = values
