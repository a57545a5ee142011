#!/usr/bin/env bash
# Tests the launcher without setting up a machine: a copy of it and of tools/setup in an empty tree,
# with stand-ins for the programs it calls. Argument: the project's root.
# shellcheck disable=SC2016  # the stand-ins' bodies are expanded when they run
set -euo pipefail
unset SLIPBENCH_PRESET

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir -p "$work/tree/tools" "$work/bin" "$work/elsewhere"
cp "$1/slipbench" "$work/tree/"
cp -r "$1/tools/setup" "$work/tree/tools/"
cd "$work/elsewhere"

fail() {
  printf 'FAILED: %s\nstatus %s\nstdout: %s\nstderr: %s\n' "$1" "$status" "$(<"$work/stdout")" "$(<"$work/stderr")"
  exit 1
}
stand_in() {
  printf '#!/bin/bash\n%s\n' "$2" >"$work/bin/$1"
  chmod +x "$work/bin/$1"
}
# Runs the launcher with the stand-ins before the machine's own programs.
launch() {
  status=0
  # In a separate session, without a terminal for sudo's prompt.
  PATH=$work/bin:$PATH setsid --wait "$work/tree/slipbench" "$@" >"$work/stdout" 2>"$work/stderr" || status=$?
}

# Neither root nor sudo: prints the one command to run, exits with 2, tries nothing.
stand_in dpkg-query 'exit 1'
stand_in id 'echo 1000'
stand_in sudo 'exit 1'
stand_in apt-get 'echo "apt-get was called" >&2; exit 1'
launch run scene.yaml </dev/null
[[ $status == 2 ]] || fail "missing packages end with 2"
grep -q 'apt-get install --yes --no-install-recommends g++ .*cmake' "$work/stderr" || fail "the command to run is printed"
grep -q 'was called' "$work/stderr" && fail "apt-get is left alone without rights"
[[ ! -s $work/stdout ]] || fail "set-up keeps off stdout"

# Root: prints what it installs, and installs it.
stand_in id 'echo 0'
stand_in apt-get "echo \"\$@\" >>'$work/apt'; exit 1"
launch run scene.yaml
[[ $status == 2 ]] || fail "a failed installation ends with 2"
grep -q '^slipbench: installing Debian packages: g++ .*cmake' "$work/stderr" || fail "set-up says what it installs"
[[ $(<"$work/apt") == *update* ]] || fail "apt-get is called"

# All installed: builds the program quietly and runs it in the caller's folder with the caller's
# words.
stand_in dpkg-query 'for word in "${@:4}"; do echo "$word installed"; done'
export work
stand_in python3 'mkdir -p "${@: -1}/bin"; printf "#!/bin/bash\necho \"\$*\" >>\"\$work/pip\"\n" >"${@: -1}/bin/pip"; cp "${@: -1}/bin/pip" "${@: -1}/bin/python"
chmod +x "${@: -1}"/bin/*'
stand_in cmake 'echo chatter; echo "$*" >>calls
if [[ $1 == --preset ]]; then mkdir -p build/release/bin; touch build/release/build.ninja; else
printf "#!/bin/bash\nprintf \"<%%s>\" \"\$PWD\" \"\$@\"; printf \"%%s\" \"\$SLIPBENCH_CALLED_AS\" >&2; exit 7\n" >build/release/bin/slipbench; chmod +x build/release/bin/slipbench; fi'
launch run 'my scene.yaml' --json
[[ $status == 7 ]] || fail "the program's exit status is the launcher's"
[[ $(<"$work/stdout") == "<$work/elsewhere><run><my scene.yaml><--json>" ]] || fail "stdout holds what the program printed, alone"
grep -q "$work/tree/slipbench$" "$work/stderr" || fail "the program knows by which name it was called"
grep -q '^slipbench: installing into build/venv: mujoco-core==4\.[0-9.]* numpy==' "$work/stderr" || fail "set-up names packages and no hashes"
[[ $(grep -c -E -- ' --require-hashes --only-binary :all: .*/requirements\.txt$' "$work/pip") == 1 ]] ||
  fail "pip takes only what the lists have a hash of"

# Set-up runs only once; the build is checked each time.
stand_in python3 'echo "python3 was called" >&2; exit 1'
launch list
[[ $status == 7 ]] || fail "a second call runs"
[[ $(grep -vc build "$work/tree/calls") == 1 && $(grep -c build "$work/tree/calls") == 2 ]] || fail "configured once, built twice"

# The program may start Python, whose module is of the same sources.
grep -q slipbench_python_where_possible "$work/tree/calls" || fail "the module is built with the program"

# Configures again after a change of the presets, or of a package that came another way.
touch -d '+1 minute' "$work/tree/CMakePresets.json"
launch list
[[ $(grep -vc build "$work/tree/calls") == 2 ]] || fail "changed presets are configured"
rm "$work/tree/CMakePresets.json"

# A failing build shows its output on stderr, including a last line without its end.
stand_in cmake 'printf "a first "; sleep 2; echo part; printf "no end"; exit 1'
launch list
[[ $(grep -cE '^(a first part|no end)$' "$work/stderr") == 2 ]] || fail "no part of a line is lost"
stand_in cmake 'echo "error: no such thing"; exit 1'
launch run scene.yaml
[[ $status == 2 ]] || fail "a failed build ends with 2"
grep -q 'no such thing' "$work/stderr" || fail "a failed build is shown"
[[ ! -s $work/stdout ]] || fail "a failed build keeps off stdout"

# A second call waits for the first.
stand_in cmake 'echo "$$ begins" >>order; sleep 0.3; echo "$$ ends" >>order'
launch run & launch run & wait
[[ $(awk '{ print $2 }' "$work/tree/order" | tr '\n' ' ') == "begins ends begins ends " ]] || fail "two builds at a time"

launch demo now
[[ $status == 2 ]] || fail "demo takes no arguments"
launch docs now
[[ $status == 2 && $(<"$work/stderr") == "slipbench: docs takes no arguments, found: now" ]] || fail "docs takes no arguments"

# Long steps are reported at least every five seconds: the step, the number of steps, and the
# command's last output.
stand_in cmake 'echo "[1/9] Building"; sleep 7; echo "[9/9] Linking"'
launch list
grep -q 'step 4 of 4: build build/release: .* s, \[1/9\] Building' "$work/stderr" || fail "a step in a log says what is being done"
[[ $(grep -c 'step 4 of 4' "$work/stderr") -ge 3 ]] || fail "a step of seven seconds is reported at its begin, after five seconds and at its end"
grep -q 'step 4 of 4: build build/release: done in [78] s' "$work/stderr" || fail "a step's end is reported"

# `demo` builds its own program alone, and runs it for each scene.
stand_in cmake 'echo "$*" >>demo_calls; [[ $1 == --preset ]] || { printf "#!/bin/bash\necho \"\$@\"\n" >build/release/bin/slipbench_demo; chmod +x build/release/bin/slipbench_demo; }'
launch demo
[[ $status == 0 && $(grep -c -- '--target slipbench_demo$' "$work/tree/demo_calls") == 1 ]] || fail "demo builds what it needs"
[[ $(grep -c "^$work/tree/scenes/papillarray/.*\.yaml $work/tree/build/demo/.*\.h5 $work/tree/build/demo/.*\.html$" "$work/stdout") == 2 ]] ||
  fail "demo writes two reports"

# Only the tests need further releases of MuJoCo.
launch plugin-path
[[ ! -e $work/tree/build/mujoco ]] || fail "an unused package is installed"

SLIPBENCH_PRESET=debug launch test --all
[[ $status == 2 ]] || fail "--all is of one preset"

# The suite of the build, and what --all adds, are passed to ctest with the other words; its exit
# status is returned.
stand_in cmake true
stand_in ctest 'echo "<$*>"; exit 3'
launch test -R Field
[[ $status == 3 && $(<"$work/stdout") == "<--preset release --parallel "*" -R Field>" ]] || fail "words after test go to ctest"
grep -q '^VERSION_ID="12"' /etc/os-release || exit 0  # others have no clang 14
launch test --all -R Field
[[ $status == 3 && $(<"$work/stdout") == "<--preset all --parallel "*" -R Field>" ]] || fail "--all asks for all tests"
