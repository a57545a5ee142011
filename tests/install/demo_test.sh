#!/usr/bin/env bash
# The demo's program writes the dataset that `slipbench sweep` writes, and a report; it refuses a scene that needs MuJoCo. Arguments: the
# project's root, the folder of the programs.
set -euo pipefail

root=$1
programs=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() { printf 'FAILED: %s\n' "$1"; exit 1; }

cd "$root"
"$programs/slipbench_demo" scenes/papillarray/stage.yaml "$work/demo.h5" "$work/demo.html" >"$work/stdout"
"$programs/slipbench" sweep scenes/papillarray/stage.yaml -o "$work/sweep.h5" --quiet
cmp "$work/demo.h5" "$work/sweep.h5" || fail "the datasets differ"
grep -q '^<!doctype html>' -i "$work/demo.html" || fail "no report"
grep -q 'gross slip at' "$work/stdout" || fail "no summary"

status=0
"$programs/slipbench_demo" scenes/grasp/lift.yaml "$work/lift.h5" "$work/lift.html" >/dev/null 2>"$work/stderr" || status=$?
[[ $status == 2 && ! -e $work/lift.h5 ]] || fail "a scene that needs MuJoCo ends with status $status"
grep -q 'lift.yaml:[0-9]*: .*MuJoCo' "$work/stderr" || fail "the message does not name the line: $(<"$work/stderr")"
if "$programs/slipbench_demo" scenes/papillarray/stage.yaml "$work/full.h5" "$work/full.html" >/dev/full 2>/dev/null; then fail "a full disk behind stdout"; fi
