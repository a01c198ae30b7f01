"""The import graph of both packages, read from their source; includes imports inside functions and for types only."""

import ast
from pathlib import Path
from typing import Dict, Iterator, List, Set

PACKAGE = "aro_robocop_goto_as"


class Imports:
    """The import graph of what is in `src/`. Names of the lab's modules leave out its package: `world.sdf.reader`."""

    def __init__(self, source: Path) -> None:
        self._source = source
        self.paths = {_short(_name(path.relative_to(source))): path for path in sorted(source.rglob("*.py"))}
        self.internal: Dict[str, Set[str]] = {}  # module -> modules of these packages
        self.external: Dict[str, Set[str]] = {}  # module -> full names from elsewhere, generated messages included
        for module, path in self.paths.items():
            names = set(self._imported(module, path))
            self.internal[module] = {name for name in names if name in self.paths and name != module}
            self.external[module] = {name for name in names if name not in self.paths}

    def _imported(self, module: str, path: Path) -> Iterator[str]:
        parts = _name(path.relative_to(self._source)).split(".")
        folder = parts if path.name == "__init__.py" else parts[:-1]
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"), filename=str(path))):
            if isinstance(node, ast.Import):
                yield from (_short(alias.name) for alias in node.names)
            elif isinstance(node, ast.ImportFrom):
                base = folder[: len(folder) - node.level + 1] if node.level else []
                base += node.module.split(".") if node.module else []
                for alias in node.names:
                    submodule = _short(".".join([*base, alias.name]))
                    yield submodule if submodule in self.paths else _short(".".join(base))

    def cycles(self) -> List[List[str]]:
        """Groups of modules that import each other, directly or indirectly."""
        reachable = {module: self._reachable_from(module) for module in self.paths}
        tangles = {
            tuple(sorted(other for other in reached if module in reachable[other]))
            for module, reached in reachable.items()
            if module in reached
        }
        return sorted(map(list, tangles))

    def _reachable_from(self, module: str) -> Set[str]:
        reached: Set[str] = set()
        waiting = [module]
        while waiting:
            new = self.internal[waiting.pop()] - reached
            reached |= new
            waiting.extend(new)
        return reached


def _name(path: Path) -> str:
    parts = path.with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def _short(name: str) -> str:
    return "" if name == PACKAGE else name.replace(f"{PACKAGE}.", "", 1)


def within(module: str, *folders: str) -> bool:
    """Whether a module is one of these modules or in one of these folders."""
    return any(module == folder or module.startswith(f"{folder}.") for folder in folders)
