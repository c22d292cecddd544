"""What the tree defines: files, modules, classes with their members, keys of files, texts of the code."""

from __future__ import annotations

import ast
import re
import subprocess
import tomllib
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath

CODE = ("space_robot*", "benchmarks", "examples", "launch")
IDENTIFIER = re.compile(r"[A-Za-z_]\w*")


@dataclass(slots=True)
class Class:
    """A class as its source says: what it derives from, its members, and the types of those that have one."""

    bases: set[str]
    members: dict[str, set[str]] = field(default_factory=lambda: defaultdict(set))


def files_of(root: Path) -> set[str]:
    """Files under version control, or about to be."""
    listed = ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
    names = subprocess.run(listed, cwd=root, capture_output=True, text=True, check=True).stdout.split("\0")
    return {name for name in names if name and (root / name).is_file()}


class Tree:
    """Files under version control (or about to be) and the names that the Python code among them defines."""

    def __init__(self, root: Path) -> None:
        self.root = root
        self.files = files_of(root)
        self.paths = self.files | {str(folder) for name in self.files for folder in PurePosixPath(name).parents}
        # What a page may call them that speaks of one folder: `kernel/aba.py`.
        self.endings = {"/".join(parts[cut:]) for parts in map(_parts, self.paths) for cut in range(len(parts))}
        self.modules: dict[str, set[str]] = {}
        self.classes: dict[str, list[Class]] = defaultdict(list)
        self.aliases: dict[str, set[str]] = defaultdict(set)
        self.functions: set[str] = set()
        self.texts: set[str] = set()
        for name in sorted(self.files):
            if name.endswith(".py") and any(PurePosixPath(name).parts[0].startswith(c.rstrip("*")) for c in CODE):
                self._read(name)
        data_files = tomllib.loads((root / "pyproject.toml").read_text())["tool"]["setuptools"]["data-files"]
        self.installed = {str(folder) for name in data_files for folder in (name, *PurePosixPath(name).parents)}
        self.keys = self._keys()

    def members(self, name: str) -> dict[str, set[str]]:
        """Members of all classes of that name and of their bases, with the types they mention."""
        found: dict[str, set[str]] = defaultdict(set)
        seen, queue = set(), [name]
        while queue:
            if (current := queue.pop()) in seen:
                continue
            seen.add(current)
            for one in self.classes.get(current, ()):
                queue += one.bases
                for member, types in one.members.items():
                    found[member] |= types
        return found

    def types(self, names: set[str]) -> set[str]:
        """The classes that names in an annotation stand for, aliases (unions of specs) followed."""
        seen: set[str] = set()
        queue = list(names)
        while queue:
            if (current := queue.pop()) not in seen:
                seen.add(current)
                queue += self.aliases.get(current, ())
        return seen & set(self.classes)

    def _keys(self) -> dict[str, set[str]]:
        """Member -> the members of what it holds, over all classes; so ``a.b`` is a key if b is among those of a."""
        keys: dict[str, set[str]] = defaultdict(set)
        for name in self.classes:
            for member, types in self.members(name).items():
                keys[member] |= {inner for held in self.types(types) for inner in self.members(held)}
        # The one place where the type is chosen by another key.
        keys["gains"] |= {key for name in self.classes if name.endswith("Gains") for key in self.members(name)}
        return keys

    def _read(self, name: str) -> None:
        tree = ast.parse((self.root / name).read_text(encoding="utf-8"))
        path = PurePosixPath(name).with_suffix("")
        module = ".".join(path.parts[:-1] if path.name == "__init__" else path.parts)
        self.modules[module] = {found for node in tree.body for found in _bound(node)}
        texts, prose = {}, set()
        for node in ast.walk(tree):
            match node:
                case ast.Constant(value=str(text)):
                    texts[id(node)] = text
                # Docstrings and the pieces of f-strings are no names.
                case ast.Expr():
                    prose.add(id(node.value))
                case ast.JoinedStr():
                    prose |= {id(part) for part in node.values}
                case ast.FunctionDef() | ast.AsyncFunctionDef():
                    self.functions.add(node.name)
                case ast.ClassDef():
                    self.classes[node.name].append(_class(node))
        said = {text for key, text in texts.items() if key not in prose}
        self.texts |= said
        if path.name == "__init__":  # names that are handed on when asked for
            self.modules[module] |= {text for text in said if IDENTIFIER.fullmatch(text)}
        for node in tree.body:
            if isinstance(node, ast.Assign) and len(node.targets) == 1 and isinstance(node.targets[0], ast.Name):
                self.aliases[node.targets[0].id] |= _names(node.value)


def _parts(path: str) -> tuple[str, ...]:
    return PurePosixPath(path).parts


def _bound(node: ast.stmt) -> Iterator[str]:
    """The names that a statement at the top of a module binds."""
    match node:
        case ast.FunctionDef() | ast.AsyncFunctionDef() | ast.ClassDef():
            yield node.name
        case ast.Import() | ast.ImportFrom():
            yield from (alias.asname or alias.name for alias in node.names)
        case ast.Assign() | ast.AnnAssign():
            targets = node.targets if isinstance(node, ast.Assign) else [node.target]
            yield from (found.id for target in targets for found in ast.walk(target) if isinstance(found, ast.Name))
        case ast.If() | ast.Try():
            for inner in ast.iter_child_nodes(node):
                if isinstance(inner, ast.stmt):
                    yield from _bound(inner)


def _class(node: ast.ClassDef) -> Class:
    found = Class({IDENTIFIER.findall(ast.unparse(base))[-1] for base in node.bases})
    for item in node.body:
        match item:
            case ast.FunctionDef() | ast.AsyncFunctionDef():
                found.members[item.name] |= _names(item.returns)
                for inner in ast.walk(item):
                    match inner:
                        case ast.Attribute(value=ast.Name(id="self"), attr=name, ctx=ast.Store()):
                            found.members[name] |= set()
            case ast.AnnAssign(target=ast.Name(id=name)):
                found.members[name] |= _names(item.annotation)
                found.members[_alias(item.value) or name] |= _names(item.annotation)
            case ast.Assign():
                for target in item.targets:
                    if isinstance(target, ast.Name):
                        found.members[target.id] |= set()
            case ast.ClassDef():
                found.members[item.name] |= set()
    return found


def _alias(value: ast.expr | None) -> str:
    """What a field is called in files, if it says so: ``Field(alias="lambda")``."""
    for keyword in value.keywords if isinstance(value, ast.Call) else ():
        if keyword.arg == "alias" and isinstance(keyword.value, ast.Constant):
            return str(keyword.value.value)
    return ""


def _names(node: ast.expr | None) -> set[str]:
    """Every name in an expression, those in quoted annotations too."""
    found: set[str] = set()
    for inner in ast.walk(node) if node is not None else ():
        match inner:
            case ast.Name(id=name) | ast.Attribute(attr=name):
                found.add(name)
            case ast.Constant(value=str(text)):
                found |= set(IDENTIFIER.findall(text))
    return found
