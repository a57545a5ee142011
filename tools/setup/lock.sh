#!/usr/bin/env bash
# Pins every PyPI package that requirements*.in need, of theirs too, to one version and the SHA-256 of each file that PyPI has of it:
# requirements*.txt. Keeps the versions that are pinned already, but for those the words ask for: lock.sh --upgrade-package NAME, or lock.sh --upgrade.
# Needs the network and python3 of the oldest version that the project supports, 3.11: another one may resolve to other packages.
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")"
# pip-compile would write the user's own package index and folders into the files.
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
# In this order: requirements-test.in takes requirements.txt as given.
for set in requirements requirements-test requirements-lock requirements-wheel; do
  "$work/bin/pip-compile" --quiet --generate-hashes --allow-unsafe --strip-extras --no-emit-index-url "$@" \
    --output-file "$set.txt" "$set.in"
done
# A second release of MuJoCo, in a folder of its own and without what it needs itself: only its own entry.
"$work/bin/pip-compile" --quiet --generate-hashes --strip-extras --no-emit-index-url --no-header --no-annotate --output-file - requirements-mujoco.in |
  awk '!/^ / { keep = index($0, "mujoco==") == 1 } keep' >requirements-mujoco.txt
