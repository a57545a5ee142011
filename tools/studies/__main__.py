"""`python -m slipbench_studies FILE`: the command `reproduce`, started by the program.

Exit status 2 for bad input, with its message, 130 after Ctrl-C.
"""

import importlib
import json
import sys
from typing import Any

from slipbench._program import (
    catch_signals,
    printable,
    read_request,
    run_command,
    say,
    write_result,
)
from slipbench_studies.catalogue import STUDIES, check_options, find_study
from slipbench_studies.kept import interrupted_text, remove_kept
from slipbench_studies.result import Options, Result, result_object, say_nothing


def module_of(name: str) -> str:
    """The module of PAPER/TABLE."""
    return "slipbench_studies." + name.replace("-", "_").replace("/", ".")


def run(name: str, options: Options) -> Result:
    """Runs a study.

    Args:
        name: PAPER/TABLE
        options: requested options

    Returns:
        its result

    Raises:
        InputError: for bad input
        KeyboardInterrupt: after Ctrl-C
    """
    result: Result = importlib.import_module(module_of(name)).study(options)
    return result


def _say(text: str) -> None:
    say(f"slipbench: {printable(text)}\n")


def _reproduce(name: str, options: Options, as_json: bool) -> int:
    """Runs a study, writes and prints its result; returns the exit status."""
    catch_signals()
    check_options(find_study(name), options)
    if options.output:
        from slipbench_studies import page

        page.check_charts(options.output)
    result = run(name, options)
    files: list[str] = []
    if options.output:
        files = page.write(options.output, name, result)
        remove_kept(options.output)
    return write_result(lambda: _print_result(name, result, files, as_json))


def main(request: dict[str, Any]) -> int:
    """Runs the requested study, writes and prints its result.

    Without a name it prints the list of studies.

    Args:
        request: name, json, quiet, install (the command that installs the studies' requirements),
            and the fields of `Options`

    Returns:
        the exit status
    """
    name, as_json, quiet, install = (
        request.pop(key) for key in ("name", "json", "quiet", "install")
    )
    options = Options(
        **{
            **request,
            "only": tuple(request["only"]),
            "say": say_nothing if as_json or quiet else _say,
        }
    )
    if name in ("", "list"):
        return run_command(lambda: write_result(lambda: _print_list(as_json)))
    return run_command(
        lambda: _reproduce(name, options, as_json),
        needs=f"reproduce: {name}",
        install=install,
        target=options.output,
        interrupted=lambda: interrupted_text(options.output),
    )


def _print_list(as_json: bool) -> None:
    if as_json:
        print(
            json.dumps(
                {"reproductions": [{"name": one.name, "summary": one.summary} for one in STUDIES]},
                separators=(",", ":"),
            )
        )
        return
    for one in STUDIES:
        print(f"{one.name:<34}  {one.summary}")


def _print_result(name: str, result: Result, files: list[str], as_json: bool) -> None:
    if as_json:
        print(json.dumps(result_object(name, result), separators=(",", ":"), ensure_ascii=False))
        return
    from slipbench_studies import text

    text.show(result)
    for file in files:
        print(f"written: {printable(file)}")


if __name__ == "__main__":
    sys.exit(main(read_request()))
