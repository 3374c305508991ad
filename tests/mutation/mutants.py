"""Mutants of Python source: each is the module with one small fault."""

import ast
import copy
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from types import CodeType

# A test negated, not moved by its boundary: `<` and `<=` differ at one float only
_OPPOSITE: dict[type[ast.cmpop], type[ast.cmpop]] = {
    ast.Lt: ast.GtE, ast.GtE: ast.Lt, ast.Gt: ast.LtE, ast.LtE: ast.Gt, ast.Eq: ast.NotEq,
    ast.NotEq: ast.Eq, ast.Is: ast.IsNot, ast.IsNot: ast.Is, ast.In: ast.NotIn, ast.NotIn: ast.In,
}  # fmt: skip
_OTHER_OPERATOR: dict[type[ast.operator], type[ast.operator]] = {
    ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Div, ast.Div: ast.Mult, ast.FloorDiv: ast.Mult,
    ast.Mod: ast.Mult, ast.Pow: ast.Mult, ast.BitAnd: ast.BitOr, ast.BitOr: ast.BitAnd,
    ast.LShift: ast.RShift, ast.RShift: ast.LShift,
}  # fmt: skip
_OTHER_FUNCTION = {"min": "max", "max": "min"}
_CONDITIONS = (ast.Name, ast.Attribute, ast.Call)
_FUNCTIONS = (ast.FunctionDef, ast.AsyncFunctionDef)


@dataclass(frozen=True, slots=True)
class Mutant:
    """One fault. path: relative to the repository. name: of the enclosing function or class, dotted.
    first_line: of the outermost enclosing function, decorators included; 0 outside of functions.
    """

    path: str
    line: int
    name: str
    before: str
    after: str
    first_line: int
    index: int  # among the faults of the file

    @property
    def text(self) -> str:
        """Where it is and what it does."""
        return f"{self.path}:{self.line} {self.name}: {self.before} → {self.after}"


@dataclass(slots=True)
class _Site:
    """A node, and where it hangs."""

    node: ast.AST
    replace: Callable[[ast.AST], None]
    names: tuple[str, ...]
    first_line: int


def mutants_of(root: Path, path: str) -> list[Mutant]:
    """All mutants of one file, in the order of its source."""
    found: list[Mutant] = []
    tree = ast.parse((root / path).read_text())
    for site in _sites(tree):
        for fault in _faults(site.node):
            line = getattr(site.node, "lineno", 0)
            name, before, after = ".".join(site.names), _short(site.node), _short(fault)
            found.append(Mutant(path, line, name, before, after, site.first_line, len(found)))
    return found


def compiled(root: Path, mutant: Mutant) -> CodeType:
    """The module's code with this fault."""
    path = root / mutant.path
    tree = ast.parse(path.read_text())
    index = 0
    for site in _sites(tree):
        for fault in _faults(site.node):
            if index == mutant.index:
                site.replace(ast.copy_location(fault, site.node))
                return compile(ast.fix_missing_locations(tree), str(path), "exec", dont_inherit=True)
            index += 1
    raise ValueError(f"{mutant.path} has no fault {mutant.index}")


def recording(root: Path, path: str, recorder: str) -> CodeType:
    """The module's code, in which each outermost function begins with recorder((file, first line))."""
    tree = ast.parse((root / path).read_text())
    for function in _outermost(tree):
        call = ast.parse(f"{recorder}(({str(root / path)!r}, {_first_line(function)}))").body[0]
        for node in ast.walk(call):
            ast.copy_location(node, function.body[0])
        function.body.insert(0, call)
    return compile(tree, str(root / path), "exec", dont_inherit=True)


def _outermost(node: ast.AST) -> Iterator[ast.FunctionDef | ast.AsyncFunctionDef]:
    for child in ast.iter_child_nodes(node):
        if isinstance(child, _FUNCTIONS):
            yield child
        else:
            yield from _outermost(child)


def _first_line(function: ast.FunctionDef | ast.AsyncFunctionDef) -> int:
    return min([function.lineno, *(one.lineno for one in function.decorator_list)])


def _short(node: ast.AST) -> str:
    return " ".join(ast.unparse(node).split())[:100]


def _sites(tree: ast.Module) -> list[_Site]:
    sites: list[_Site] = []
    _collect(tree, (), 0, sites)
    return sites


def _collect(node: ast.AST, names: tuple[str, ...], first_line: int, sites: list[_Site]) -> None:
    for field, value in ast.iter_fields(node):
        if field in ("annotation", "returns", "decorator_list", "type_params", "bases"):
            continue
        for at, child in enumerate(value) if isinstance(value, list) else ((-1, value),):
            if not isinstance(child, ast.AST) or _is_left_out(child):
                continue
            here, line = names, first_line
            if isinstance(child, (*_FUNCTIONS, ast.ClassDef)):
                here = (*names, child.name)
            if isinstance(child, _FUNCTIONS) and not first_line:
                line = _first_line(child)
            # Defaults of arguments belong to the code around the function
            outside = isinstance(node, ast.arguments)
            sites.append(_Site(child, _setter(node, field, at), here, 0 if outside else line))
            _collect(child, here, line, sites)


def _setter(parent: ast.AST, field: str, at: int) -> Callable[[ast.AST], None]:
    def set_attribute(node: ast.AST) -> None:
        setattr(parent, field, node)

    def set_item(node: ast.AST) -> None:
        getattr(parent, field)[at] = node

    return set_item if at >= 0 else set_attribute


def _is_left_out(node: ast.AST) -> bool:
    """Imports, texts, slots, and what only a type checker reads."""
    if isinstance(node, ast.Import | ast.ImportFrom | ast.JoinedStr | ast.Raise | ast.Assert):
        return True
    if isinstance(node, ast.Assign):
        return any(isinstance(target, ast.Name) and target.id == "__slots__" for target in node.targets)
    return isinstance(node, ast.If) and isinstance(node.test, ast.Name) and node.test.id == "TYPE_CHECKING"


def _faults(node: ast.AST) -> Iterator[ast.AST]:
    """Every faulty node that may stand for this one."""
    if isinstance(node, ast.Compare):
        yield from _compare_faults(node)
    elif isinstance(node, ast.BinOp | ast.AugAssign) and type(node.op) in _OTHER_OPERATOR:
        yield _changed(node, op=_OTHER_OPERATOR[type(node.op)]())
    elif isinstance(node, ast.BoolOp):
        yield _changed(node, op=ast.Or() if isinstance(node.op, ast.And) else ast.And())
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not | ast.USub):
        yield node.operand
    elif isinstance(node, ast.Constant):
        yield from _constant_faults(node)
    elif isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in _OTHER_FUNCTION:
        yield _changed(node, func=ast.Name(_OTHER_FUNCTION[node.func.id], ast.Load()))
    elif isinstance(node, ast.Return) and node.value is not None:
        yield from _return_faults(node)
    if isinstance(node, ast.If | ast.IfExp | ast.While) and isinstance(node.test, _CONDITIONS):
        yield _changed(node, test=ast.UnaryOp(ast.Not(), node.test))
    if _is_effect(node):
        yield ast.Pass()


def _compare_faults(node: ast.Compare) -> Iterator[ast.AST]:
    for at, op in enumerate(node.ops):
        yield _changed(node, ops=[*node.ops[:at], _OPPOSITE[type(op)](), *node.ops[at + 1 :]])


def _constant_faults(node: ast.Constant) -> Iterator[ast.AST]:
    value = node.value
    if isinstance(value, bool):
        yield ast.Constant(not value)
    elif isinstance(value, int):
        yield ast.Constant(value + 1)
    elif isinstance(value, float):
        yield ast.Constant(2.0 * value if value else 1.0)


def _return_faults(node: ast.Return) -> Iterator[ast.AST]:
    value = node.value
    if isinstance(value, ast.Tuple) and len(value.elts) > 1:
        yield _changed(node, value=_changed(value, elts=value.elts[::-1]))
    elif not isinstance(value, ast.Constant):
        yield _changed(node, value=ast.Constant(None))


def _is_effect(node: ast.AST) -> bool:
    """A call for its effect, or something that is remembered; without a local variable nothing would run."""
    if isinstance(node, ast.Expr):
        return isinstance(node.value, ast.Call)
    if isinstance(node, ast.Assign):
        return all(isinstance(target, ast.Attribute | ast.Subscript) for target in node.targets)
    return isinstance(node, ast.AugAssign)


def _changed(node: ast.AST, **fields: object) -> ast.AST:
    changed = copy.copy(node)
    for name, value in fields.items():
        setattr(changed, name, value)
    return changed
