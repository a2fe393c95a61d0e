"""The house rules that a reader cannot see being broken: who imports whom, what is final, how long a file is."""

import ast
import importlib
import inspect
import pkgutil
import statistics
from collections.abc import Iterator
from pathlib import Path

import equinox as eqx
import pytest

import axffit

ROOT = Path(axffit.__file__).parent
FILES = sorted(ROOT.rglob("*.py"))
LONGEST_FILE = 450
LONGEST_MEDIAN = 200

GROUND_FLOOR = {"_types", "errors", "frames", "numerics", "hemisphere", "spectrum"}
# Lowest floor first. A package sees itself and every floor below; packages on one floor do not see each other.
FLOORS = (
    GROUND_FLOOR,
    {"brdf"},
    {"axf", "measured"},
    {"textures"},
    {"targets"},
    {"quantization", "fitting", "preview", "synthesis"},
    {"testing"},
    {"report"},
    {"cli"},
)
# `testing` is for the users' own tests; the package itself does without it.
HIDDEN = {"testing"}
ENGINES = ("unity", "hdrp", "unreal", "mdl")


def part_of(path: Path) -> str:
    """The room a file belongs to: the first name below `axffit`."""
    return path.relative_to(ROOT).parts[0].removesuffix(".py")


def allowed_imports(part: str) -> set[str]:
    below: set[str] = set()
    for floor in FLOORS:
        if part in floor:
            return below | (floor if part in GROUND_FLOOR else {part})
        below |= floor - HIDDEN
    raise AssertionError(f"axffit/{part} stands on no floor: add it to FLOORS in {__file__}")


def parse(path: Path) -> ast.Module:
    return ast.parse(path.read_text(encoding="utf-8"))


def imported_parts(path: Path) -> Iterator[tuple[int, str]]:
    """Each room of axffit that a file imports, with the line, function-level and type-checking imports included."""
    package = ["axffit", *path.relative_to(ROOT).parts[:-1]]
    for node in ast.walk(parse(path)):
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            base = package[: len(package) - node.level + 1] if node.level else []
            module = ".".join([*base, *([node.module] if node.module else [])])
            names = [f"{module}.{alias.name}" for alias in node.names] if module == "axffit" else [module]
        else:
            continue
        for name in names:
            parts = name.split(".")
            if parts[0] == "axffit" and len(parts) > 1 and not parts[1].startswith("__version"):
                yield node.lineno, parts[1]


def name_of(path: Path) -> str:
    return str(path.relative_to(ROOT.parent))


# What lies beside the ground floor (`__init__`, `__main__`) only hands on to the rooms.
IN_ROOMS = [path for path in FILES if path.parent != ROOT or part_of(path) in GROUND_FLOOR]


@pytest.mark.parametrize("path", IN_ROOMS, ids=name_of)
def test_imports_run_one_way(path):
    allowed = allowed_imports(part_of(path))
    wrong = [f"line {line} imports axffit.{part}" for line, part in imported_parts(path) if part not in allowed]
    assert not wrong, f"{name_of(path)} may import {sorted(allowed)}: {wrong}"


def test_nothing_imports_the_command_line():
    importers = [name_of(path) for path in FILES for _, part in imported_parts(path) if part == "cli"]
    assert not [name for name in importers if not name.startswith(("axffit/cli/", "axffit/__main__"))]


@pytest.mark.parametrize("path", FILES, ids=name_of)
def test_no_file_is_too_long(path):
    assert len(path.read_text(encoding="utf-8").splitlines()) <= LONGEST_FILE


def test_files_are_short_in_the_median():
    lengths = [len(path.read_text(encoding="utf-8").splitlines()) for path in FILES if path.name != "__init__.py"]
    assert statistics.median(lengths) <= LONGEST_MEDIAN


def modules_of_equinox() -> list[type]:
    """Every equinox Module class that axffit defines."""
    found = set()
    for info in pkgutil.walk_packages([str(ROOT)], "axffit."):
        if info.name != "axffit.__main__":
            for value in vars(importlib.import_module(info.name)).values():
                if inspect.isclass(value) and issubclass(value, eqx.Module) and value.__module__ == info.name:
                    found.add(value)
    return sorted(found, key=lambda cls: (cls.__module__, cls.__qualname__))


def test_every_module_is_abstract_or_final():
    classes = modules_of_equinox()
    assert len(classes) > 5
    for cls in classes:
        for base in cls.__bases__:
            if base.__module__.startswith("axffit"):
                assert inspect.isabstract(base), f"{cls.__qualname__} subclasses the concrete {base.__qualname__}"


def test_only_abstract_methods_are_overridden():
    for cls in modules_of_equinox():
        for base in cls.__mro__[1:]:
            if not base.__module__.startswith("axffit"):
                continue
            own = {name for name, value in vars(cls).items() if inspect.isfunction(value) and not name.startswith("__")}
            for name in own & set(vars(base)):
                abstract = getattr(vars(base)[name], "__isabstractmethod__", False)
                assert abstract, f"{cls.__qualname__}.{name} overrides the concrete {base.__qualname__}.{name}"


def words_of_code(tree: ast.Module) -> Iterator[tuple[int, str]]:
    """Names and strings of a file that are code, not documentation."""
    documentation = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):
            documentation.add(node.value)
    for node in ast.walk(tree):
        if isinstance(node, ast.Name):
            yield node.lineno, node.id
        elif isinstance(node, ast.Attribute):
            yield node.lineno, node.attr
        elif isinstance(node, ast.arg):
            yield node.lineno, node.arg
        elif isinstance(node, ast.ClassDef | ast.FunctionDef):
            yield node.lineno, node.name
        elif isinstance(node, ast.Constant) and isinstance(node.value, str) and node not in documentation:
            yield node.lineno, node.value


@pytest.mark.parametrize("path", sorted((ROOT / "brdf").glob("*.py")), ids=name_of)
def test_brdf_knows_no_engine(path):
    found = [(line, word) for line, word in words_of_code(parse(path)) if any(e in word.lower() for e in ENGINES)]
    assert not found


def calls_of(tree: ast.Module) -> Iterator[tuple[int, str]]:
    for node in ast.walk(tree):
        if isinstance(node, ast.Call):
            yield node.lineno, ast.unparse(node.func)


@pytest.mark.parametrize("path", FILES, ids=name_of)
def test_no_global_switches_and_no_printing(path):
    calls = list(calls_of(parse(path)))
    assert not [line for line, name in calls if name.endswith("config.update")]
    if part_of(path) != "cli":
        assert not [line for line, name in calls if name == "print"]


@pytest.mark.parametrize("path", FILES, ids=name_of)
def test_annotations_stay_objects_where_they_are_checked(path):
    names = {
        alias.name if node.module == "__future__" else node.module
        for node in ast.walk(parse(path))
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
    }
    assert not {"annotations", "jaxtyping"} <= names


def is_array_like_check(node: ast.AST) -> bool:
    return (
        isinstance(node, ast.Call)
        and ast.unparse(node.func) == "isinstance"
        and len(node.args) == 2
        and "ArrayLike" in ast.unparse(node.args[1])
    )


@pytest.mark.parametrize("path", FILES, ids=name_of)
def test_nothing_asks_whether_a_value_is_array_like(path):
    # False for a traced value on Python 3.11 with JAX 0.10.
    assert not [node for node in ast.walk(parse(path)) if is_array_like_check(node)]


def undocumented(tree: ast.Module) -> Iterator[str]:
    scopes: list[tuple[str, ast.Module | ast.ClassDef]] = [("", tree)]
    while scopes:
        prefix, scope = scopes.pop()
        for node in scope.body:
            if not isinstance(node, ast.ClassDef | ast.FunctionDef) or node.name.startswith("_"):
                continue
            if not ast.get_docstring(node) and "overload" not in {ast.unparse(d) for d in node.decorator_list}:
                yield f"{prefix}{node.name} (line {node.lineno})"
            if isinstance(node, ast.ClassDef):
                scopes.append((f"{prefix}{node.name}.", node))


@pytest.mark.parametrize("path", FILES, ids=name_of)
def test_everything_public_has_a_docstring(path):
    tree = parse(path)
    assert ast.get_docstring(tree), "the file says nothing about itself"
    assert not list(undocumented(tree))
