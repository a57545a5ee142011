"""The package's public names."""

import importlib
import inspect
import pkgutil
from collections.abc import Iterator
from types import FunctionType, ModuleType
from typing import Any

import slipbench


def modules() -> list[ModuleType]:
    """Returns the package and its public modules."""
    names = [
        module.name
        for module in pkgutil.iter_modules(slipbench.__path__)
        if not module.name.startswith("_")
    ]
    return [slipbench, *(importlib.import_module(f"slipbench.{name}") for name in names)]


def offered() -> dict[str, Any]:
    """Returns classes and functions by name."""
    found = {name: vars(module)[name] for module in modules() for name in module.__all__}
    return {
        name: value
        for name, value in found.items()
        if inspect.isclass(value) or inspect.isfunction(value)
    }


def functions() -> Iterator[tuple[str, FunctionType]]:
    """Yields functions, methods and property getters by qualified name.

    A protocol's methods are excluded: users write them.
    """
    for name, value in offered().items():
        if inspect.isfunction(value):
            yield name, value
        elif not getattr(value, "_is_protocol", False):
            for member, made in vars(value).items():
                function = (
                    made.fget if isinstance(made, property) else getattr(made, "__func__", made)
                )
                if not member.startswith("_") and inspect.isfunction(function):
                    yield f"{name}.{member}", function
