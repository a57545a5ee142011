#!/usr/bin/env bash
# Pins every PyPI package that requirements*.in need, with dependencies, to one version and the
# SHA-256 of each of its files on PyPI, in requirements*.txt. Keeps pinned versions, except with the
# arguments --upgrade-package NAME or --upgrade. Needs the network and python3 of the oldest
# supported version, 3.11: other versions may resolve to other packages.
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")"
# Otherwise pip-compile writes the user's own package index and folders into the files.
unset PIP_INDEX_URL PIP_EXTRA_INDEX_URL PIP_FIND_LINKS
export CUSTOM_COMPILE_COMMAND=tools/setup/lock.sh

python3 -c 'import sys; sys.exit(sys.version_info[:2] != (3, 11))' || {
  echo "lock.sh: needs python3 of version 3.11, found: $(python3 --version)" >&2
  exit 2
}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work"
"$work/bin/pip" install --quiet --require-hashes --only-binary :all: --requirement requirements-lock.txt
# The order matters: requirements-test.in is constrained by requirements.txt.
for set in requirements requirements-test requirements-lock requirements-wheel; do
  "$work/bin/pip-compile" --quiet --generate-hashes --allow-unsafe --strip-extras --no-emit-index-url "$@" \
    --output-file "$set.txt" "$set.in"
done
# Each further release of MuJoCo goes into a separate folder without dependencies: keeps only its own
# entry.
mapfile -t releases < <(awk '/^mujoco/ { print $1 }' requirements-mujoco.in)
for release in "${releases[@]}"; do
  "$work/bin/pip-compile" --quiet --generate-hashes --strip-extras --no-emit-index-url --no-header --no-annotate --output-file - - <<<"$release" |
    awk -v wanted="$release" '!/^ / { keep = $1 == wanted } keep'
done >requirements-mujoco.txt
