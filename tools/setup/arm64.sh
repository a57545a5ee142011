#!/usr/bin/env bash
# Creates build/arm64-system, for the preset `arm64`: the libraries of the set `build` in packages.txt
# as Debian 12 has them for arm64, and the wheels of requirements.txt for arm64. Nothing in it is
# installed or run. Does nothing if it exists for the same lists. Needs Debian's mmdebstrap and
# tools/setup/setup.sh python.
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$here/../.." && pwd)
system=$root/build/arm64-system
lists=("$here/packages.txt" "$here/requirements.txt" "${BASH_SOURCE[0]}")

hash=$(sha256sum "${lists[@]}" | cut -d ' ' -f 1 | sha256sum)
[[ ! -f $system/lists || $(<"$system/lists") != "$hash" ]] || exit 0

rm -rf "$system" "$system.part"
mkdir -p "$root/build"
# shellcheck disable=SC2016  # apt-get expands it
mirror=$(apt-get indextargets --format '$(REPO_URI)' 2>/dev/null | grep -m 1 '/debian/*$' || echo http://deb.debian.org/debian)
packages=$(awk '$1 == "build" && ($2 ~ /^lib.*-dev$/ || $2 ~ /^(zlib|nlohmann)/) { print $2 }' "$here/packages.txt" | paste -sd ,)
mmdebstrap --quiet --architectures=arm64 --variant=extract --include="libc6-dev,$packages" bookworm "$system.part" \
  "deb [signed-by=/usr/share/keyrings/debian-archive-keyring.gpg] $mirror bookworm main"
# The emulator looks for every file here first; these are of the machine that it runs on.
rm -rf "${system:?}.part"/{dev,etc,proc,run,sys,tmp,var}
"$root/build/venv/bin/python3" -m pip install --disable-pip-version-check --quiet --progress-bar off --require-hashes --only-binary :all: \
  --no-deps --python-version 3.11 --implementation cp --platform manylinux_2_35_aarch64 --platform manylinux_2_28_aarch64 \
  --platform manylinux_2_27_aarch64 --platform manylinux2014_aarch64 --platform any \
  --target "$system.part/wheels" --requirement "$here/requirements.txt"
printf '%s\n' "$hash" >"$system.part/lists"
mv "$system.part" "$system"
