"""Compile a text to a program: the grammar of expressions, parsed by precedence.

    a if c else b  <  or  <  and  <  not  <  comparisons  <  + -  <  * /  <  unary + -  <  **

Only the kernel's evaluator computes, no Python code object is made, and a text has access only to the names in its
scope. Raises Finding.
"""

from __future__ import annotations

import math
from functools import partial

from heuncli.base.errors import Finding
from heuncli.base.spelling import suggest
from heuncli.base.units import RATE, UNITS, Dimension, canonical_symbol, parse_unit
from heuncli.results.results_schema import REPORT_OF
from heuncli.scene.expressions.codegen import COMPARISONS, CodeGenerator, Part
from heuncli.scene.expressions.dimensions import (
    FACTOR,
    FREE,
    coordinate_dimension,
    known_dimension,
    literal_dimension,
    power_dimension,
)
from heuncli.scene.expressions.motion_laws import ARGUMENTS, TEXTS, make_motion_law
from heuncli.scene.expressions.programs import OWN, POINTS, Expression
from heuncli.scene.expressions.scope import (
    ARITY,
    CONSTANTS,
    COORDINATES_BY_TYPE,
    LAW_HINT,
    LIBRARIES,
    POINT_FORM_HINT,
    REACTIONS,
    RESERVED,
    RESULT_BLOCKS,
    WORDS,
    DependentError,
    Scope,
    describe_dimensions,
    find_dimension,
    resolve_point,
    unknown_name_finding,
)
from heuncli.scene.expressions.token_reader import TokenReader

MAX_LENGTH, MAX_DEPTH = 2000, 48
MAX_WHOLE_POWER = 64  # whole powers up to this are multiplied out
BINARY = {"+": (1, "add"), "-": (1, "sub"), "*": (2, "mul"), "/": (2, "div")}
FIXED_VALUE_HINT = "this value is read once, before the run: use only numbers and parameters"


def compile_expression(text: str, scope: Scope) -> Expression:
    """Compile the expression of a text. Raises Finding."""
    require_length(text)
    cache = scope.calculations if not scope.with_units else None
    cached = cache.recalculate(text, scope.parameters, partial(find_dimension, scope)) if cache is not None else None
    if cached is not None:
        return cached
    try:
        parser = _Parser(text, scope)
        expression = parser.parse()
        if cache is not None and expression.constant is not None:
            cache.store(text, expression, parser.codegen.sources, partial(find_dimension, scope))
        return expression
    except Finding as finding:
        if finding.code != "wrong-dimension":
            raise
        hint = "; ".join(filter(None, [describe_dimensions(text, scope), finding.hint]))
        raise Finding(finding.code, f"'{text.strip()}' {finding.message}", hint) from None


def require_length(text: str) -> None:
    """Raise Finding [expression-limit] for a text too long to be an expression, or a number with a unit."""
    if len(text) > MAX_LENGTH:
        hint = "define parts of it under parameters; put many points in a table"
        raise Finding(
            "expression-limit", f"an expression of {len(text)} characters; at most {MAX_LENGTH} are allowed", hint
        )


def too_deep_finding() -> Finding:
    """Make the error of an expression with too many nested parentheses."""
    message = f"the expression is nested more than {MAX_DEPTH} levels deep"
    return Finding("expression-limit", message, "define its inner parts under parameters, or simplify it")


class _Parser(TokenReader):
    """Parses one text."""

    def __init__(self, text: str, scope: Scope) -> None:
        super().__init__(text, scope)
        self.depth = 0
        self.codegen = CodeGenerator(strict=scope.with_units)

    def parse(self) -> Expression:
        if not self.tokens:
            raise Finding("expression-syntax", "an empty expression", "write a number, or leave out the key")
        part = self.parse_expression()
        if self.position < len(self.tokens):
            raise self.unexpected_token_error()
        return self.codegen.make_expression(self.text, part)

    def parse_expression(self) -> Part:
        """Parse a value, perhaps by cases."""
        self.depth += 1
        if self.depth > MAX_DEPTH:
            raise too_deep_finding()
        part = self.parse_or()
        if self.take_token("if"):
            begin = self.position
            condition = self.parse_or()
            text = self.text_since(begin)
            self.expect_token("else", "after 'if'")
            part = self.codegen.make_choice(condition, part, self.parse_expression(), text)
        self.depth -= 1
        return part

    def parse_or(self) -> Part:
        begin = self.position
        part = self.parse_and()
        if self.token != "or":
            return part
        text = self.text_since(begin)
        while self.take_token("or"):
            one, begin = self.codegen.make_number(1.0), self.position
            other = self.parse_and()
            part = self.codegen.make_choice(part, one, self.codegen.make_truth(other, self.text_since(begin)), text)
        return part._replace(is_condition=True)

    def parse_and(self) -> Part:
        begin = self.position
        part = self.parse_not()
        if self.token != "and":
            return part
        text = self.text_since(begin)
        while self.take_token("and"):
            begin = self.position
            other = self.parse_not()
            truth = self.codegen.make_truth(other, self.text_since(begin))
            part = self.codegen.make_choice(part, truth, self.codegen.make_number(0.0), text)
        return part._replace(is_condition=True)

    def parse_not(self) -> Part:
        count = 0
        while self.take_token("not"):
            count += 1
        begin = self.position
        part = self.parse_comparison()
        if not count:
            return part
        text = self.text_since(begin)
        for _ in range(min(count, 2 + count % 2)):
            part = self.codegen.make_truth(part, text, "eq")
        return part._replace(is_condition=True)

    def parse_comparison(self) -> Part:
        """Parse a, a < b, or a chain a < b < c, in which b runs once."""
        next_begin = self.position
        first = self.parse_binary(1)
        if self.token not in COMPARISONS:
            return first
        right, links = first, []
        while self.token in COMPARISONS:
            name, begin = COMPARISONS[self.token], next_begin
            self.position += 1
            next_begin = self.position
            left, right = right, self.parse_binary(1)
            links.append((name, left, right, self.text_since(begin)))
        if len(links) > 1:
            return self.codegen.make_chain(first, links)._replace(is_condition=True)
        name, left, right, text = links[0]
        return self.codegen.make_operation(name, left, right, text=text)._replace(is_condition=True)

    def parse_binary(self, level: int) -> Part:
        part = self.parse_unary()
        while self.token in BINARY and BINARY[self.token][0] >= level:
            precedence, name = BINARY[self.token]
            self.position += 1
            part = self.codegen.make_operation(name, part, self.parse_binary(precedence + 1))
        return part

    def parse_unary(self) -> Part:
        minus, signs = False, 0
        while self.token in ("-", "+"):
            minus ^= self.token == "-"
            signs += 1
            self.position += 1
        part = self.parse_power()
        return self.codegen.make_operation("neg", part) if minus else part

    def parse_power(self) -> Part:
        part = self.parse_operand()
        if not self.take_token("**"):
            return part
        self.depth += 1
        if self.depth > MAX_DEPTH:
            raise too_deep_finding()
        exponent = self.parse_unary()  # binds to the right: 2**-3**2
        self.depth -= 1
        n = exponent.constant
        if not self.codegen.is_literal(exponent):  # the choice of operation depends on the value
            self.codegen.sources = None
        measure = power_dimension(part.measure, n, exponent.measure)
        if n is not None and n == int(n if math.isfinite(n) else 0.0) and 2.0 <= abs(n) <= MAX_WHOLE_POWER:
            whole = self.codegen.make_operation("power", part, argument=int(abs(n)))
            result = whole if n > 0.0 else self.codegen.make_operation("div", self.codegen.make_number(1.0), whole)
        else:
            result = self.codegen.make_operation("pow", part, exponent)
        return result._replace(measure=measure)

    def parse_operand(self) -> Part:
        kind, token = self.kind, self.token
        if kind == "number":
            self.position += 1
            return self.parse_number(token)
        if kind == "name" and token not in WORDS:
            self.position += 1
            if self.take_token("("):
                return self.parse_call(token)
            if self.take_token("."):
                return self.parse_point() if token == POINTS and self.is_point() else self.parse_coordinate(token)
            return self.parse_name(token)
        if self.take_token("("):
            part = self.parse_expression()
            self.expect_token(")", "to close a parenthesis")
            return part
        raise self.unexpected_token_error()

    def parse_number(self, figure: str) -> Part:
        """Parse a number, perhaps with its unit: 2 kN, also 2*kN where that is no product with a parameter."""
        measure, value = literal_dimension(figure), float(figure)
        if self.is_unit_factor():
            self.position += 1
        has_unit = (self.kind == "name" and self.token not in WORDS) or self.token == "°" or self.is_reciprocal_unit()
        if has_unit and not self.scope.with_units and canonical_symbol(self.token) not in (*UNITS, "1"):
            raise self.unexpected_token_error()
        if has_unit:
            if not self.scope.with_units:
                self.require_no_parameter(figure, " ", self.token)
            size, dimension = self.parse_unit_name(figure)
            measure, value = known_dimension(dimension), value * size
        if not math.isfinite(value):
            raise Finding("not-computable", f"{figure} is too large", "the largest number is 1.8e308")
        return self.codegen.make_number(value, measure)

    def is_unit_factor(self) -> bool:
        """Return whether *kN stands here: a unit of several letters that is no name of this model, nor a constant."""
        ahead = [token for _, token, _ in self.tokens[self.position : self.position + 2]]
        mark, name = ahead if len(ahead) == 2 else ("", "")
        is_name_free = name not in self.scope.parameters and name not in RESERVED and name not in self.scope.own
        return mark == "*" and len(name) > 1 and canonical_symbol(name) in UNITS and is_name_free

    def is_reciprocal_unit(self) -> bool:
        """Return whether 1/s stands here: after a number it is a unit."""
        ahead = [token for _, token, _ in self.tokens[self.position : self.position + 3]]
        return len(ahead) == 3 and ahead[:2] == ["1", "/"] and canonical_symbol(ahead[2]) in UNITS

    def parse_unit_name(self, figure: str) -> tuple[float, Dimension]:
        """Parse the unit that stands here, names joined by * and / with whole powers; return its size and dimension."""
        begin = self.position
        if canonical_symbol(self.token) not in UNITS and (
            self.token in self.scope.parameters or self.token in RESERVED
        ):
            raise self.unexpected_token_error()
        self.position += 1
        while self.position < len(self.tokens):
            mark, after = [token for _, token, _ in (*self.tokens[self.position : self.position + 2], ("", "", 0))][:2]
            if mark in ("^", "**") and after.isdecimal():
                self.position += 2
            elif mark in ("*", "/") and canonical_symbol(after) in UNITS:
                self.require_no_parameter(f"{figure} {self.text_since(begin)}", mark, after)
                self.position += 2
            elif self.kind == "name" and canonical_symbol(mark) in UNITS:
                self.position += 1
            else:
                break
        return parse_unit(self.text_since(begin))

    def require_no_parameter(self, quantity: str, mark: str, name: str) -> None:
        """Raise Finding for 2 m, or 2 m/s, if s or m is a parameter, too."""
        if name in self.scope.parameters:
            message = f"'{quantity}{mark}{name}': {name} is both a unit and a parameter of this model"
            product = f"{quantity}*{name}" if mark == " " else f"({quantity}){mark}{name}"
            hint = f"for the parameter write {product}; for the unit rename the parameter"
            raise Finding("expression-syntax", message, hint)

    def parse_call(self, name: str) -> Part:
        begin = self.position - 2
        if name in self.scope.parameters or name in ("t", *CONSTANTS):
            raise Finding("unknown-name", f"'{name}' is not a function", f"for a product write {name}*(...)")
        if name in self.scope.tables:
            raise Finding("unknown-name", f"'{name}' is a table, not a function", f"write table({name}, ...)")
        if name not in ARITY:
            raise unknown_name_finding(self.scope, name, "function")
        if name == "table":
            return self.parse_table()
        parts: list[Part] = []
        decimal = None
        while not self.take_token(")"):
            if parts:
                decimal = decimal or self.suggest_decimal_point(self.position)
                self.expect_token(",", f"or ')' in {name}(...)")
            parts.append(self.parse_expression())
        least, most = ARITY[name]
        if not least <= len(parts) <= most:
            count = f"{least}" if least == most else f"{least} or more"
            message = f"{name}() takes {count} argument{'s' if count != '1' else ''}, not {len(parts)}"
            arguments = ", ".join("xyz"[:least]) + (", ..." if most > least else "")
            hint = decimal or f"write {TEXTS.get(name, f'{name}({arguments})')}"
            if name == "log":
                hint = "log is the natural logarithm; for base b write log(x)/log(b)"
            raise Finding("function-arguments", message, hint)
        text = self.text_since(begin)
        if name in ARGUMENTS:
            return make_motion_law(self.codegen, name, parts, text)
        part = self.codegen.make_operation(name, *parts[:2], text=text)
        for other in parts[2:]:
            part = self.codegen.make_operation(name, part, other, text=text)
        return part

    def parse_table(self) -> Part:
        """Parse table(name, x), with the name of an entry of `tables:`."""
        begin, name = self.position - 2, self.token if self.kind == "name" else ""
        self.position += 1
        if not name or not self.take_token(","):
            quoted = self.tokens[self.position - 1][1] in ("'", '"')
            hint = "write no quotes" if quoted else "inside { } and [ ] an expression with a comma needs quotes"
            message = "table() takes a table's name and a value: table(gas, shaft.angle)"
            raise Finding("function-arguments", message, hint)
        argument = self.parse_expression()
        self.expect_token(")", "to close table(...)")
        if not self.scope.in_time:
            raise Finding(
                "not-in-time", "a table is allowed only in functions of time (forces, drives)", FIXED_VALUE_HINT
            )
        if name not in self.scope.tables:
            hint = suggest(name, self.scope.tables, "tables")
            raise Finding("unknown-table", f"'{name}' is not a table", hint)
        table = self.scope.tables[name]
        if table is None:
            raise DependentError
        return self.codegen.make_lookup(table, argument, self.text_since(begin))

    def parse_coordinate(self, joint: str) -> Part:
        """Parse joint.quantity, of a joint with one coordinate."""
        quantity = self.token
        if self.kind != "name":
            raise self.unexpected_token_error()
        self.position += 1
        joints = self.scope.joints
        if quantity in REACTIONS or (joint in RESULT_BLOCKS and joint not in joints):
            message = f"'{joint}.{quantity}': reactions cannot be used in expressions, they result from the motion"
            raise Finding("unknown-name", message, LAW_HINT)
        if not self.scope.in_time:
            message = f"{joint}.{quantity} is allowed only in functions of time (forces, drives)"
            raise Finding("not-in-time", message, FIXED_VALUE_HINT)
        if joint not in joints:
            hint = f"write {quantity}" if joint in LIBRARIES else suggest(joint, joints, "joints")
            if joint in self.scope.points:
                hint = (
                    f"a point is {POINTS}.{joint}.{quantity}.x"
                    if quantity in self.scope.points[joint]
                    else POINT_FORM_HINT
                )
            if joint in REPORT_OF:
                hint = "use paths of results in {of: joints.NAME.force.z, below: 0}, and NAME.angle in expressions"
            raise Finding("unknown-name", f"'{joint}.{quantity}': '{joint}' is not a joint", hint)
        words = COORDINATES_BY_TYPE.get(joints[joint], ())
        if quantity not in words:
            known = "; ".join(f"{kind}: {', '.join(w)}" for kind, w in COORDINATES_BY_TYPE.items())
            has = f"has {' and '.join(words)}" if words else "has no single coordinate"
            message = f"'{joint}.{quantity}': a joint of type {joints[joint]} {has}, not '{quantity}'"
            raise Finding("unknown-coordinate", message, f"coordinates of joints: {known}")
        return self.codegen.make_coordinate(joint, quantity)

    def is_point(self) -> bool:
        """Return whether a point stands here, and not a coordinate of a joint that is named points."""
        ahead = [token for _, token, _ in self.tokens[self.position + 1 : self.position + 2]]
        return POINTS not in self.scope.joints or ahead == ["."]

    def parse_point(self) -> Part:
        """Parse points.BODY.POINT.quantity, or points.POINT.quantity if only one body has a point of that name."""
        words = [self.token]
        self.position += 1
        while self.take_token("."):
            words.append(self.token)
            self.position += 1
        text = ".".join((POINTS, *words))
        if not self.scope.in_time:
            raise Finding(
                "not-in-time", f"{text} is allowed only in functions of time (forces, conditions)", FIXED_VALUE_HINT
            )
        body, point, quantity = resolve_point(text, words, self.scope.points)
        return self.codegen.make_coordinate(f"{POINTS}.{body}.{point}", quantity)

    def parse_name(self, name: str) -> Part:
        if name in self.scope.own:
            if name in self.scope.parameters:
                message = f"'{name}' is both a parameter and a quantity of the load itself"
                raise Finding("unknown-name", message, "give the parameter another name")
            return self.codegen.make_coordinate(OWN, self.scope.own[name])
        if name in self.scope.parameters:
            value = self.scope.parameters[name]
            if value is None:
                raise DependentError
            dimensioned = self.scope.given.get(name)
            return self.codegen.make_number(
                value, known_dimension(dimensioned.dimension) if dimensioned is not None else FREE, name
            )
        if name in CONSTANTS:
            return self.codegen.make_number(CONSTANTS[name], coordinate_dimension(RATE) if name == "rpm" else FACTOR)
        if name == "t":
            if not self.scope.in_time:
                raise Finding(
                    "not-in-time", "the time t is allowed only in functions of time (forces, drives)", FIXED_VALUE_HINT
                )
            return self.codegen.make_time()
        if name in ARITY:
            arguments = "a, b" if ARITY[name][0] > 1 else "t"
            raise Finding("function-arguments", f"{name} is a function", f"write {name}(...), e.g. {name}({arguments})")
        raise unknown_name_finding(self.scope, name, "parameter")
