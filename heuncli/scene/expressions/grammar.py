"""From text to program: the grammar of expressions, read by precedence.

    a if c else b  <  or  <  and  <  not  <  comparisons  <  + -  <  * /  <  unary + -  <  **

Nothing is evaluated but by the kernel's evaluator, no Python code object is made, and a text can reach nothing but the
names it is given. Raises Finding.
"""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Mapping
from functools import partial
from types import MappingProxyType
from typing import Any

from heuncli.base.errors import Finding
from heuncli.base.joint_kinds import RATES, TYPES
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.nearest import did_you_mean, nearest
from heuncli.base.records import record
from heuncli.base.units import RATE, UNITS, Dimension, describe, in_si, parse_unit, spelling_of
from heuncli.results.results_schema import REPORT_OF, ROWS, SHARED
from heuncli.scene.expressions.calculations import Calculations
from heuncli.scene.expressions.codegen import COMPARISONS, MOST_NODES, Codegen, Part
from heuncli.scene.expressions.dimensions import FACTOR, FREE, known, loose, of_literal, raised
from heuncli.scene.expressions.point_names import FORM, point_meant
from heuncli.scene.expressions.programs import OWN, POINTS, Expression, TableFunction
from heuncli.scene.expressions.tokens import tokens_of

LONGEST, DEEPEST = 2000, 48
LARGEST_POWER = 64  # whole powers up to this one are multiplied out

CONSTANTS = {"pi": math.pi, "deg": math.pi / 180.0, "rpm": math.pi / 30.0}
OF_ONE_NUMBER = (
    "sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh", "exp", "log", "sqrt", "abs", "sign", "step",
)  # fmt: skip
ARITY: dict[str, tuple[int, int]] = {
    **dict.fromkeys(OF_ONE_NUMBER, (1, 1)),
    "atan2": (2, 2),
    **dict.fromkeys(("min", "max", "hypot"), (2, MOST_NODES)),
    "table": (2, 2),
}
WORDS = frozenset({"if", "else", "and", "or", "not"})
RESERVED = frozenset({"t", *CONSTANTS, *ARITY, *WORDS})
COORDINATES = {  # of the joints of one freedom
    kind.name: (quantity, RATES[quantity])
    for kind in TYPES.values()
    for quantity in kind.coordinates
    if kind.coordinates == (quantity,)
}
BINARY = {"+": (1, "add"), "-": (1, "sub"), "*": (2, "mul"), "/": (2, "div")}
OTHER_NAMES = {  # what people write who come from elsewhere
    "arcsin": "asin", "arccos": "acos", "arctan": "atan", "arctan2": "atan2", "ln": "log", "fabs": "abs", "sgn": "sign",
    "heaviside": "step", "time": "t", "PI": "pi", "Pi": "pi", "π": "pi", "degrees": "deg", "pow": "**", "sqr": "**2",
    "interp": "table(NAME, ...)", "lookup": "table(NAME, ...)", "spline": "table(NAME, ...)",
}  # fmt: skip
LOADS = SHARED | {"stops", "couplings"}  # blocks of the results that are found from the motion
REACTIONS = frozenset(
    row.path.split(".")[2]
    for row in ROWS
    if row.path.startswith(("joints.JOINT.", "stops.STOP.")) and set(row.units) & {"N", "N·m"}
) - {"shares"}
LAWS = (
    "a law takes t, parameters and coordinates, as shaft.angle, shaft.rate, guide.travel, guide.speed; "
    "a condition takes {of: joints.NAME.force.z, below: 0}"
)
LIBRARIES = frozenset({"math", "np", "numpy", "sp", "Math"})  # whose functions are written with a dot elsewhere

NONE: Mapping[str, Any] = MappingProxyType({})


@record
class Scope:
    """The names an expression may use. A parameter or table of value None is known, but was itself in error.

    joints gives the type of each, points those of each body and of the ground; time, coordinates and points may be used
    only where in_time. given: the parameters that have
    a dimension, as they are written. with_units: numbers may have units, and what is compared is of one dimension.
    calculations: numbers of parameters alone that were read before, in a spec whose names are the same. own: what of
    the load itself a name means, as `length` of a spring's line: its quantity.
    """

    parameters: Mapping[str, float | None] = NONE
    joints: Mapping[str, str] = NONE
    tables: Mapping[str, TableFunction | None] = NONE
    in_time: bool = False
    given: Mapping[str, GivenParameter] = NONE
    points: Mapping[str, Collection[str]] = NONE
    with_units: bool = False
    calculations: Calculations | None = None
    own: Mapping[str, str] = NONE


FIXED = "this one is read once, before the run: give it as a number or by parameters"


NO_COORDINATE = "only a pin and a slide have coordinates: shaft.angle, guide.travel"


class GivenParameter(NamedTuple):
    """A parameter with a dimension, as it is written."""

    dimension: Dimension
    text: str

    def told(self, name: str) -> str:
        """In words."""
        return f"{name} = {self.text} is {describe(self.dimension)}"


class Follows(Finding):
    """Something this value depends on is in error; that error is reported, this one is not."""

    def __init__(self) -> None:
        super().__init__("follows", "depends on something that is in error", "mend that first")


def compile_expression(text: str, scope: Scope) -> Expression:
    """The expression a text means. Raises Finding."""
    require_length(text)
    known = scope.calculations if not scope.with_units else None
    found = known.again(text, scope.parameters, partial(dimension_in, scope)) if known is not None else None
    if found is not None:
        return found
    try:
        parser = _Parser(text, scope)
        expression = parser.parse()
        if known is not None and expression.constant is not None:
            known.keep(text, expression, parser.codegen.sources, partial(dimension_in, scope))
        return expression
    except Finding as finding:
        if finding.code != "wrong-dimension":
            raise
        hint = "; ".join(filter(None, [told_of(text, scope), finding.hint]))
        raise Finding(finding.code, f"'{text.strip()}' {finding.message}", hint) from None


def dimension_in(scope: Scope, name: str) -> Dimension | None:
    """The dimension of a parameter, if it has one."""
    given = scope.given.get(name)
    return given.dimension if given is not None else None


def require_length(text: str) -> None:
    """Refuse what is too long to be an expression, or a number with a unit. Raises Finding."""
    if len(text) > LONGEST:
        hint = "parts of it may have names under parameters; many points are a table"
        raise Finding("expression-limit", f"an expression of {len(text)} characters; at most {LONGEST} are read", hint)


def told_of(text: str, scope: Scope) -> str | None:
    """The dimensions of the parameters in a text, in words: a hint."""
    names = dict.fromkeys(found[0] for found in re.finditer(r"[^\W\d]\w*", text) if found[0] in scope.given)
    return ", ".join(scope.given[name].told(name) for name in names) or None


def too_deep() -> Finding:
    """The error of an expression with too many parentheses within each other."""
    message = f"an expression nested more than {DEEPEST} deep"
    return Finding("expression-limit", message, "name its inner parts under parameters, or write it as a sum")


class _Parser:
    """One reading of one text."""

    def __init__(self, text: str, scope: Scope) -> None:
        self.text, self.scope = text, scope
        self.tokens, self.kinds, self.words = tokens_of(text)
        self.at = 0
        self.nested = 0
        self.codegen = Codegen(strict=scope.with_units)

    def parse(self) -> Expression:
        if not self.tokens:
            raise Finding("expression-syntax", "an empty expression", "write a number, or leave the key out")
        part = self.expression()
        if self.at < len(self.tokens):
            raise self.unexpected()
        return self.codegen.finished(self.text, part)

    # tokens

    @property
    def token(self) -> str:
        """The next token, empty at the end."""
        return self.words[self.at]

    @property
    def kind(self) -> str:
        return self.kinds[self.at]

    def take(self, token: str) -> bool:
        if self.words[self.at] == token:
            self.at += 1
            return True
        return False

    def expect(self, token: str, where: str) -> None:
        if not self.take(token):
            found = f", found '{self.token}'" if self.token else ""
            hint = f"put '{token}' before it" if found else "inside { } and [ ] an expression with a comma needs quotes"
            raise self.syntax(f"expected '{token}' {where}{found}", hint)

    def syntax(self, message: str, hint: str) -> Finding:
        place = self.tokens[self.at][2] - len(self.token) + 1 if self.at < len(self.tokens) else len(self.text) + 1
        return Finding("expression-syntax", f"'{self.text.strip()}' at character {place}: {message}", hint)

    def unexpected(self) -> Finding:
        """What does not belong where it stands, with the hint for what was probably meant."""
        hints = {
            "^": "a power is written **", "%": "write x - n*y; there is no remainder", "//": "write /",
            "&&": "write and", "||": "write or", "&": "write and", "|": "write or", "!": "write not",
            "=": "compare with > or <, in a choice with ==",
            ":": "a value by cases is: a if c else b", "?": "a value by cases is: a if c else b",
            "×": "write *", "·": "write *", "÷": "write /", "−": "write the plain minus sign -",
        }  # fmt: skip
        if not self.token:
            return self.syntax("it ends too early", "a value is missing: as 2*L, or 5*sin(t)")
        hint = hints.get(self.token)
        if self.token == "%" and self.at == len(self.tokens) - 1:
            hint = "a part of a hundred is written as 0.5 for 50 %"
        if hint is None and self.kind == "name" and self.at and self.tokens[self.at - 1][0] != "number":
            hint = self.product_hint()
        if (
            hint is None
            and self.token not in WORDS
            and self.kind in ("name", "number")
            and self.at
            and self.tokens[self.at - 1][0] in ("name", "number")
        ):
            before = self.tokens[self.at - 1][1]
            known = self.token in self.scope.parameters or self.token in RESERVED
            hint = (None if known else in_si(before, self.token)) or f"for a product write {before}*{self.token}"
        if hint is None:
            hint = self.product_hint() if self.at else None
        if hint is None and self.token == ",":
            hint = self.decimal(self.at)
        if hint is None and self.token == "if":
            hint = "a value by cases is: a if c else b"
        if hint is None and self.token == "[":
            hint = "points stand in a table: tables: {NAME: {x: [0, 1], y: [5, 7]}}, and here table(NAME, x)"
        if hint is None and self.token == "." and self.at and self.tokens[self.at - 1][1] == ")":
            hint = "only a joint has coordinates: shaft.angle, guide.travel"
        plain = "an expression is of numbers, names, + - * / ** and ( )"
        return self.syntax(f"'{self.token}' is not expected here", hint or plain)

    def product_hint(self) -> str | None:
        """A hint for 2(t + 1), and for a unit behind an expression."""
        kind, before, _ = self.tokens[self.at - 1]
        if self.token == "(" and (kind == "number" or before == ")"):
            return f"for a product write {before}*("
        if before in (")", "t") and self.kind == "name" and in_si("", self.token) is not None:
            return f"an expression is taken in SI: leave {self.token} out"
        return None

    def decimal(self, comma: int) -> str | None:
        """A hint for 1,5: the comma stands right between two numbers."""
        around = self.tokens[max(comma - 1, 0) : comma + 2]
        if [kind for kind, _, _ in around] != ["number", "mark", "number"]:
            return None
        (_, whole, _), (_, _, end), (_, part, last) = around
        if last - len(part) != end or not part.isdigit():
            return None
        return f"a decimal is written with a point: {whole}.{part}"

    def written(self, begin: int) -> str:
        """The text from token number `begin` to the last one taken."""
        first = self.tokens[begin]
        return self.text[first[2] - len(first[1]) : self.tokens[self.at - 1][2]]

    # the grammar

    def expression(self) -> Part:
        """A value, perhaps by cases."""
        self.nested += 1
        if self.nested > DEEPEST:
            raise too_deep()
        part = self.disjunction()
        if self.take("if"):
            begin = self.at
            condition = self.disjunction()
            text = self.written(begin)
            self.expect("else", "after 'if'")
            part = self.codegen.choose(condition, part, self.expression(), text)
        self.nested -= 1
        return part

    def disjunction(self) -> Part:
        begin = self.at
        part = self.conjunction()
        if self.token != "or":
            return part
        text = self.written(begin)
        while self.take("or"):
            one, begin = self.codegen.number(1.0), self.at
            other = self.conjunction()
            part = self.codegen.choose(part, one, self.codegen.truth(other, self.written(begin)), text)
        return part

    def conjunction(self) -> Part:
        begin = self.at
        part = self.negation()
        if self.token != "and":
            return part
        text = self.written(begin)
        while self.take("and"):
            begin = self.at
            other = self.negation()
            truth = self.codegen.truth(other, self.written(begin))
            part = self.codegen.choose(part, truth, self.codegen.number(0.0), text)
        return part

    def negation(self) -> Part:
        turns = 0
        while self.take("not"):
            turns += 1
        begin = self.at
        part = self.comparison()
        if not turns:
            return part
        text = self.written(begin)
        for _ in range(min(turns, 2 + turns % 2)):
            part = self.codegen.truth(part, text, "eq")
        return part

    def comparison(self) -> Part:
        """a, a < b, or a chain a < b < c, in which b is run once."""
        next_begin = self.at
        first = self.binary(1)
        if self.token not in COMPARISONS:
            return first
        right, links = first, []
        while self.token in COMPARISONS:
            name, begin = COMPARISONS[self.token], next_begin
            self.at += 1
            next_begin = self.at
            left, right = right, self.binary(1)
            links.append((name, left, right, self.written(begin)))
        if len(links) > 1:
            return self.codegen.chain(first, links)
        name, left, right, text = links[0]
        return self.codegen.apply(name, left, right, text=text)

    def binary(self, level: int) -> Part:
        part = self.unary()
        while self.token in BINARY and BINARY[self.token][0] >= level:
            precedence, name = BINARY[self.token]
            self.at += 1
            part = self.codegen.apply(name, part, self.binary(precedence + 1))
        return part

    def unary(self) -> Part:
        minus, signs = False, 0
        while self.token in ("-", "+"):
            minus ^= self.token == "-"
            signs += 1
            self.at += 1
        part = self.power()
        return self.codegen.apply("neg", part) if minus else part

    def power(self) -> Part:
        part = self.operand()
        if not self.take("**"):
            return part
        self.nested += 1
        if self.nested > DEEPEST:
            raise too_deep()
        exponent = self.unary()  # binds to the right: 2**-3**2
        self.nested -= 1
        n = exponent.constant
        if not self.codegen.is_written(exponent):  # which operation it is hangs on it
            self.codegen.sources = None
        measure = raised(part.measure, n, exponent.measure)
        if n is not None and n == int(n if math.isfinite(n) else 0.0) and 2.0 <= abs(n) <= LARGEST_POWER:
            whole = self.codegen.apply("power", part, argument=int(abs(n)))
            result = whole if n > 0.0 else self.codegen.apply("div", self.codegen.number(1.0), whole)
        else:
            result = self.codegen.apply("pow", part, exponent)
        return result._replace(measure=measure)

    def operand(self) -> Part:
        kind, token = self.kind, self.token
        if kind == "number":
            self.at += 1
            return self.number(token)
        if kind == "name" and token not in WORDS:
            self.at += 1
            if self.take("("):
                return self.call(token)
            if self.take("."):
                return self.point() if token == POINTS and self.is_point() else self.coordinate(token)
            return self.name(token)
        if self.take("("):
            part = self.expression()
            self.expect(")", "to close a parenthesis")
            return part
        raise self.unexpected()

    def number(self, figure: str) -> Part:
        """A number, in a condition perhaps with its unit."""
        measure, value = of_literal(figure), float(figure)
        has_unit = (self.kind == "name" and self.token not in WORDS) or self.token == "°" or self.is_per()
        if has_unit and not self.scope.with_units:
            raise self.unexpected()
        if has_unit:
            size, dimension = self.unit(figure)
            measure, value = known(dimension), value * size
        if not math.isfinite(value):
            raise Finding("not-computable", f"{figure} is too large a number", "numbers go up to 1.8e308")
        return self.codegen.number(value, measure)

    def is_per(self) -> bool:
        """Whether 1/s stands here: behind a number it is a unit."""
        ahead = [token for _, token, _ in self.tokens[self.at : self.at + 3]]
        return len(ahead) == 3 and ahead[:2] == ["1", "/"] and spelling_of(ahead[2]) in UNITS

    def unit(self, figure: str) -> tuple[float, Dimension]:
        """Size and dimension of the unit that stands here: names of units joined by * and /, with whole powers."""
        begin = self.at
        if spelling_of(self.token) not in UNITS and (self.token in self.scope.parameters or self.token in RESERVED):
            raise self.unexpected()
        self.at += 1
        while self.at < len(self.tokens):
            mark, after = [token for _, token, _ in (*self.tokens[self.at : self.at + 2], ("", "", 0))][:2]
            if mark in ("^", "**") and after.isdecimal():
                self.at += 2
            elif mark in ("*", "/") and spelling_of(after) in UNITS:
                self.require_no_parameter(f"{figure} {self.written(begin)}", mark, after)
                self.at += 2
            elif self.kind == "name" and spelling_of(mark) in UNITS:
                self.at += 1
            else:
                break
        return parse_unit(self.written(begin))

    def require_no_parameter(self, quantity: str, mark: str, name: str) -> None:
        """Refuse 2 m/s where s is a parameter, too. Raises Finding."""
        if name in self.scope.parameters:
            message = f"'{quantity}{mark}{name}': {name} is a unit, and a parameter of this scene"
            hint = f"for the parameter write ({quantity}){mark}{name}; for the unit give the parameter another name"
            raise Finding("expression-syntax", message, hint)

    def call(self, name: str) -> Part:
        begin = self.at - 2
        if name in self.scope.parameters or name in ("t", *CONSTANTS):
            raise Finding("unknown-name", f"'{name}' is not a function", f"for a product write {name}*(...)")
        if name in self.scope.tables:
            raise Finding("unknown-name", f"'{name}' is a table, not a function", f"write table({name}, ...)")
        if name not in ARITY:
            raise self.unknown(name, "function")
        if name == "table":
            return self.table()
        parts: list[Part] = []
        decimal = None
        while not self.take(")"):
            if parts:
                decimal = decimal or self.decimal(self.at)
                self.expect(",", f"or ')' in {name}(...)")
            parts.append(self.expression())
        least, most = ARITY[name]
        if not least <= len(parts) <= most:
            count = f"{least}" if least == most else f"{least} or more"
            message = f"{name}() takes {count} argument{'s' if count != '1' else ''}, not {len(parts)}"
            arguments = ", ".join("xyz"[:least]) + (", ..." if most > least else "")
            hint = decimal or f"as {name}({arguments})"
            if name == "log":
                hint = "log is the natural logarithm; to the base b: log(x)/log(b)"
            raise Finding("function-arguments", message, hint)
        text = self.written(begin)
        part = self.codegen.apply(name, *parts[:2], text=text)
        for other in parts[2:]:
            part = self.codegen.apply(name, part, other, text=text)
        return part

    def table(self) -> Part:
        """table(name, x), the name of an entry of `tables:`."""
        begin, name = self.at - 2, self.token if self.kind == "name" else ""
        self.at += 1
        if not name or not self.take(","):
            quoted = self.tokens[self.at - 1][1] in ("'", '"')
            hint = "the name without quotes" if quoted else "inside { } and [ ] an expression with a comma needs quotes"
            message = "table() takes a table's name and a value: table(gas, shaft.angle)"
            raise Finding("function-arguments", message, hint)
        argument = self.expression()
        self.expect(")", "to close table(...)")
        if not self.scope.in_time:
            raise Finding("not-in-time", "a table may stand only in a value in time (forces, drives)", FIXED)
        if name not in self.scope.tables:
            hint = did_you_mean(name, self.scope.tables, "tables")
            raise Finding("unknown-table", f"'{name}' is not a table", hint)
        table = self.scope.tables[name]
        if table is None:
            raise Follows
        return self.codegen.look_up(table, argument, self.written(begin))

    def coordinate(self, joint: str) -> Part:
        """joint.quantity, of a joint of one freedom."""
        quantity = self.token
        if self.kind != "name":
            raise self.unexpected()
        self.at += 1
        joints = self.scope.joints
        if quantity in REACTIONS or (joint in LOADS and joint not in joints):
            message = (
                f"'{joint}.{quantity}': reactions cannot enter laws or other expressions, they follow from the motion"
            )
            raise Finding("unknown-name", message, LAWS)
        if not self.scope.in_time:
            message = f"{joint}.{quantity} may stand only in a value in time (forces, drives)"
            raise Finding("not-in-time", message, FIXED)
        if joint not in joints:
            hint = f"write {quantity}" if joint in LIBRARIES else did_you_mean(joint, joints, "joints")
            if joint in self.scope.points:
                hint = f"a point is {POINTS}.{joint}.{quantity}.x" if quantity in self.scope.points[joint] else FORM
            if joint in REPORT_OF:
                hint = "paths of results stand in {of: joints.NAME.force.z, below: 0}; in expressions NAME.angle"
            raise Finding("unknown-name", f"'{joint}.{quantity}': '{joint}' is not a joint", hint)
        words = COORDINATES.get(joints[joint], ())
        if quantity not in words:
            known = "; ".join(f"{kind}: {', '.join(w)}" for kind, w in COORDINATES.items())
            has = f"has {' and '.join(words)}" if words else "has no coordinate of its own"
            message = f"'{joint}.{quantity}': a joint of type {joints[joint]} {has}, not '{quantity}'"
            raise Finding("unknown-coordinate", message, f"coordinates of joints: {known}")
        return self.codegen.coordinate(joint, quantity)

    def is_point(self) -> bool:
        """Whether a point stands here, and not a coordinate of a joint that is called points."""
        ahead = [token for _, token, _ in self.tokens[self.at + 1 : self.at + 2]]
        return POINTS not in self.scope.joints or ahead == ["."]

    def point(self) -> Part:
        """points.BODY.POINT.quantity; points.POINT.quantity where one body alone has a point of that name."""
        words = [self.token]
        self.at += 1
        while self.take("."):
            words.append(self.token)
            self.at += 1
        written = ".".join((POINTS, *words))
        if not self.scope.in_time:
            raise Finding("not-in-time", f"{written} may stand only in a value in time (forces, conditions)", FIXED)
        body, point, quantity = point_meant(written, words, self.scope.points)
        return self.codegen.coordinate(f"{POINTS}.{body}.{point}", quantity)

    def name(self, name: str) -> Part:
        if name in self.scope.own:
            if name in self.scope.parameters:
                message = f"'{name}' is a parameter, and here what the load itself stands between"
                raise Finding("unknown-name", message, "give the parameter another name")
            return self.codegen.coordinate(OWN, self.scope.own[name])
        if name in self.scope.parameters:
            value = self.scope.parameters[name]
            if value is None:
                raise Follows
            given = self.scope.given.get(name)
            return self.codegen.number(value, known(given.dimension) if given is not None else FREE, name)
        if name in CONSTANTS:
            return self.codegen.number(CONSTANTS[name], loose(RATE) if name == "rpm" else FACTOR)
        if name == "t":
            if not self.scope.in_time:
                raise Finding("not-in-time", "the time t may stand only in a value in time (forces, drives)", FIXED)
            return self.codegen.time()
        if name in ARITY:
            arguments = "a, b" if ARITY[name][0] > 1 else "t"
            raise Finding("function-arguments", f"{name} is a function", f"write {name}(...), as {name}({arguments})")
        raise self.unknown(name, "parameter")

    def unknown(self, name: str, kind: str) -> Finding:
        if name in OTHER_NAMES:
            return Finding("unknown-name", f"'{name}' is not a {kind}", f"write {OTHER_NAMES[name]}")
        if kind == "parameter" and name in self.scope.joints:
            words = COORDINATES.get(self.scope.joints[name])
            hint = f"write {name}.{words[0]} or {name}.{words[1]}" if words else NO_COORDINATE
            return Finding("unknown-name", f"'{name}' is a joint, not a number", hint)
        known = (self.scope.parameters, RESERVED) if kind == "parameter" else (ARITY,)
        message, near = f"'{name}' is not a {kind}", nearest(name, *known)
        is_near = near is not None and near.lower() == name.lower()
        if not is_near and kind == "parameter" and (unit := in_si("", name)) is not None:
            return Finding("unknown-name", message, f"as in 20 {name}" if self.scope.with_units else unit)
        if kind == "parameter" and self.scope.own and near is None:
            return Finding("unknown-name", message, f"of the load itself: {', '.join(self.scope.own)}")
        listed = self.scope.parameters if kind == "parameter" else sorted(ARITY)
        hint = f"did you mean {near}?" if near else did_you_mean(name, listed, f"{kind}s")
        return Finding("unknown-name", message, hint)
