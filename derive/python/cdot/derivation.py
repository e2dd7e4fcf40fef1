"""Derivations as sympy: C, Cdot, J, K, gamma and b of a joint, and of each coordinate that it leaves free."""
from __future__ import annotations

import ast
import json
from types import MappingProxyType
from typing import Any, Callable, Mapping, Sequence

import numpy as np
import sympy

from . import _cdot

_FUNCTIONS = {name: getattr(sympy, name) for name in
              ("sqrt", "sin", "cos", "tan", "sinh", "cosh", "exp", "log", "atan2", "sign")}
_FUNCTIONS["abs"] = sympy.Abs
_OPERATORS: dict[type, Callable[[Any, Any], Any]] = {
    ast.Add: lambda x, y: x + y, ast.Sub: lambda x, y: x - y, ast.Mult: lambda x, y: x * y,
    ast.Div: lambda x, y: x / y, ast.Pow: lambda x, y: x ** y}


def _sympy_of(node: ast.expr, names: Mapping[str, sympy.Expr]) -> sympy.Expr:
    """An expression of `cdot explain --json`, node by node: whole numbers stay exact."""
    if isinstance(node, ast.Constant):
        return sympy.Integer(node.value)
    if isinstance(node, ast.Name):
        return names[node.id]
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        return -_sympy_of(node.operand, names)
    if isinstance(node, ast.BinOp):
        return _OPERATORS[type(node.op)](_sympy_of(node.left, names), _sympy_of(node.right, names))
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
        return _FUNCTIONS[node.func.id](*(_sympy_of(each, names) for each in node.args))
    raise _cdot.Error(f"an expression has an unexpected part: {ast.dump(node)}")


class Block:
    """Rows, or a coordinate: the quantities of a kernel as sympy matrices in the symbols of Derivation.symbols.

    C      [rows, 1]        the position constraint
    Cdot   [rows, 1]        its rate, J v + C_t
    C_t    [rows, 1]        dC/dt with the bodies at rest
    J      [rows, columns]  the Jacobian; Derivation.columns names the columns
    K      [rows, rows]     the effective mass matrix J M^-1 J'
    gamma  [rows, 1]        -Jdot v - dC_t/dt
    b      [rows, 1]        the right-hand side of K lambda = b: -Cdot
    """

    def __init__(self, name: str, data: Mapping[str, Any], of: Callable[[str], sympy.Expr]):
        self.name = name
        self._data, self._of = data, of

    def _matrix(self, key: str) -> sympy.Matrix:
        rows = [row if isinstance(row, list) else [row] for row in self._data[key]]
        width = len(rows[0]) if rows else 0
        return sympy.ImmutableMatrix(len(rows), width, [self._of(entry) for row in rows for entry in row])

    C = property(lambda self: self._matrix("C"), doc="[rows, 1]: the position constraint.")
    Cdot = property(lambda self: self._matrix("Cdot"), doc="[rows, 1]: its rate, J v + C_t.")
    C_t = property(lambda self: self._matrix("C_t"), doc="[rows, 1]: dC/dt with the bodies at rest.")
    J = property(lambda self: self._matrix("J"), doc="[rows, columns]: the Jacobian.")
    K = property(lambda self: self._matrix("K"), doc="[rows, rows]: the effective mass matrix J M^-1 J'.")
    gamma = property(lambda self: self._matrix("gamma"), doc="[rows, 1]: -Jdot v - dC_t/dt.")
    b = property(lambda self: -self._matrix("Cdot"), doc="[rows, 1]: the right-hand side of K lambda = b.")

    def __repr__(self) -> str:
        return f"<{type(self).__name__} {self.name}>"


class Law:
    """The law of an effect along its rows, in the symbols of Derivation.symbols. Forces act by J' F on the bodies.

    value      a symbol a row: its C; None where a turn in space has no value
    rate       a symbol a row: its Cdot
    energy     what it stores [J]; 0 if nothing
    force      [rows, 1]     F, with the part -dE/d(value)
    unstored   [rows, 1]     the part of F that has no energy
    stiffness  [rows, rows]  -dF/d(value)
    damping    [rows, rows]  -dF/d(rate)
    """

    def __init__(self, data: Mapping[str, Any], of: Callable[[str], sympy.Expr]):
        self.value: tuple[Any, ...] = tuple(of(each) if each else None for each in data["value"])
        self.rate: tuple[sympy.Expr, ...] = tuple(of(each) for each in data["rate"])
        self.energy: sympy.Expr = of(data["energy"] or "0")
        self.force, self.unstored = (sympy.ImmutableMatrix(len(data[key]), 1, [of(entry) for entry in data[key]])
                                     for key in ("force", "unstored"))
        self.stiffness, self.damping = (
            sympy.ImmutableMatrix([[of(entry) for entry in row] for row in data[key]]) for key in ("stiffness", "damping"))

    def __repr__(self) -> str:
        return f"<Law of {len(self.rate)} rows>"


class Bound:
    """A row with bounds of an effect; missing parts are None.

    lower, upper        the ends of its coordinate; if it has a rate, the bounds of its force
    by_lower, by_upper  what each unit of the load adds to these
    rate                that it prescribes
    after, until        at most 0 where it begins and where it ends
    """

    def __init__(self, data: Mapping[str, Any], of: Callable[[str], sympy.Expr]):
        self.name: str = data["name"]
        self.text: str = data["text"]
        self.coordinate: str = data["coordinate"]
        self.rate, self.lower, self.upper, self.by_lower, self.by_upper, self.after, self.until = (
            of(data[key]) if data[key] else None
            for key in ("rate", "lower", "upper", "by_lower", "by_upper", "after", "until"))

    def __repr__(self) -> str:
        return f"<Bound {self.text}>"


class Derivation(Block):
    """A joint or an effect, derived by the rules of the textbook. `law` and `bounds` are those of an effect.

    Cdot proves the specs of its catalogue with GiNaC; this module has no GiNaC and proves nothing. `cdot derive` and
    `cdot check` prove a spec of your own.
    """

    def __init__(self, texts: _cdot.Derived):
        self._texts = texts
        data = json.loads(texts.json())
        super().__init__(data["joint"], data, self._expression)
        self.title: str = data["title"]
        self.source: str = data["source"]
        self.dimension: int = data["dimension"]
        self.bodies: tuple[str, ...] = tuple(data["bodies"])
        self.columns: tuple[str, ...] = tuple(data["columns"])
        self.rows: tuple[str, ...] = tuple(row["name"] for row in data["rows"])
        self.messages: str = texts.messages
        self.guards: tuple[dict[str, str], ...] = tuple(data["guards"])
        self.meanings: Mapping[str, Mapping[str, Any]] = MappingProxyType(data["symbols"])
        self.symbols: Mapping[str, sympy.Symbol] = MappingProxyType(
            {name: sympy.Symbol(name, real=True) for name in data["symbols"]})
        self._named: dict[str, sympy.Expr] = {
            name: sympy.pi if doc["kind"] == "constant" else self.symbols[name]
            for name, doc in data["symbols"].items()}
        self._short = dict(self._named)
        for each in data["intermediates"]:
            self._named[each["name"]] = self._expression(each["definition"])
        self.coordinates: Mapping[str, Block] = MappingProxyType(
            {each["name"]: Block(each["name"], each, self._expression) for each in data["coordinates"]})
        self.law: Any = Law(data["law"], self._expression) if data["law"] else None
        self.bounds: tuple[Bound, ...] = tuple(Bound(each, self._expression) for each in data["bounds"])

    def _expression(self, text: str) -> sympy.Expr:
        return _sympy_of(ast.parse(text, mode="eval").body, self._named)

    def in_pose(self, expression: Any) -> Any:
        """The expression with arms and turned directions written out in the pose and the parameters."""
        given = {self.symbols[name]: self._expression(doc["from"])
                 for name, doc in self.meanings.items() if doc["from"]}
        for _ in given:  # one of them may be made of others
            written = expression.subs(given)
            if written == expression:
                break
            expression = written
        return expression

    def function(self, quantity: str, coordinate: str = "") -> Callable[..., np.ndarray]:
        """C, Cdot, C_t, J, K, gamma or b as a function of numbers by name, for numpy.

        The function takes the symbols that it needs by keyword: poses, velocities, inverse masses, parameters.
        Numbers may be arrays of one shape: then the result has the shape [rows, columns, *shape].
        """
        block = self.coordinates[coordinate] if coordinate else self
        matrix = self.in_pose(getattr(block, quantity))
        symbols = sorted(matrix.free_symbols, key=lambda symbol: symbol.name)
        compiled = sympy.lambdify(symbols, list(matrix), modules="numpy", cse=True)
        names = [symbol.name for symbol in symbols]

        def evaluate(**numbers: Any) -> np.ndarray:
            missing = [name for name in names if name not in numbers]
            if missing:
                raise TypeError(f"{quantity} of {self.name} needs the numbers {', '.join(missing)}")
            unknown = [name for name in numbers if name not in self.symbols]
            if unknown:
                raise TypeError(f"{self.name} has no symbols {', '.join(unknown)}; Derivation.symbols lists them")
            entries = compiled(*(np.asarray(numbers[name], dtype=float) for name in names))
            shape = np.broadcast_shapes(*(np.shape(entry) for entry in entries)) if entries else ()
            return np.array([np.broadcast_to(entry, shape) for entry in entries],
                            dtype=float).reshape(*matrix.shape, *shape)

        evaluate.__doc__ = f"{quantity} of {self.name}, from: {', '.join(names)}"
        return evaluate

    def formulas(self) -> Sequence[Sequence[tuple[str, str]]]:
        """Names, C, J and K as a person writes them, with vectors: of the rows, then of each coordinate.

        Pairs of plain text and LaTeX: ("u = pa - pb", "\\\\mathbf{u} = ...").
        """
        return self._texts.formulas()

    def latex(self) -> str:
        """The formulas of the rows in LaTeX, one a line, for amsmath."""
        block = next((each for each in self._texts.formulas() if each), [])
        lines = [latex.replace(" = ", " &= ", 1) for _, latex in block]
        return "\\begin{aligned}\n" + " \\\\\n".join(lines) + "\n\\end{aligned}"

    def lecture(self, format: str = "text", form: str = "global") -> str:
        """The derivation, step by step, as text, html or latex: the output of `cdot explain`.

        In space `form` is global, local or euler: J for w in world axes, in body axes, or for the rates of the Euler
        parameters.
        """
        if format not in ("text", "html", "latex"):
            raise ValueError(f"format must be text, html or latex, but is `{format}`")
        return getattr(self._texts, format)(form)

    def kernel(self) -> str:
        """The kernel as C++: what `cdot derive` writes into generated/."""
        return self._texts.kernel()

    def emit(self, engine: str) -> str:
        """A header that makes the joint one of an engine: box2d, bullet, dart, jolt, ode, simbody or plain."""
        return self._texts.emit(engine)

    def _repr_latex_(self) -> str:
        return "$\\displaystyle " + self.latex() + "$"


def derive(spec: str, *, specs: str = "specs") -> Derivation:
    """Reads and derives a spec: by its path, by its name ("line", "spatial/distance"), or from its text.

    `specs` is the folder in which names and includes are looked up; where there is none, that of the package. Mistakes
    raise Error with their lines and likely fixes.
    """
    return Derivation(_cdot.Derived(spec, specs))
