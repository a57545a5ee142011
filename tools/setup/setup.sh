#!/usr/bin/env bash
# Installs what the project needs: setup.sh SET..., where a SET is `build` or `test` (Debian packages of packages.txt) or
# `python` (the virtual environment build/venv). Does nothing where all is there. Talks on stderr only.
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$here/../.." && pwd)

say() { printf 'slipbench: %s\n' "$*" >&2; }

packages_of() { awk -v set="$1" '$1 == set { print $2 }' "$here/packages.txt"; }

# The packages of a set that are not installed, on one line.
missing_of() {
  local -a wanted
  mapfile -t wanted < <(packages_of "$1")
  { dpkg-query -W -f '${Package} ${db:Status-Status}\n' "${wanted[@]}" 2>/dev/null || true; } |
    awk -v wanted="${wanted[*]}" '
      $2 == "installed" { have[$1] = 1 }
      END { n = split(wanted, names, " "); for (i = 1; i <= n; ++i) if (!(names[i] in have)) printf "%s ", names[i] }'
}

install_debian() {
  if ! command -v dpkg-query >/dev/null; then
    say "no dpkg here: set-up knows Debian 12. See tools/setup/packages.txt for what to install, then build with cmake --preset release."
    exit 2
  fi
  local set missing=""
  for set in "$@"; do missing+=$(missing_of "$set"); done
  [[ -n $missing ]] || return 0
  local -a as_root=()
  if [[ $(id -u) != 0 ]]; then
    if ! command -v sudo >/dev/null || ! { sudo -n true 2>/dev/null || [[ -t 0 ]]; }; then
      say "Debian packages are missing, and neither root nor sudo is at hand. Run this as root, then try again:"
      printf '  apt-get update && apt-get install --yes --no-install-recommends %s\n' "$missing" >&2
      exit 2
    fi
    as_root=(sudo)
  fi
  say "installing Debian packages: $missing"
  local log="$root/build/setup.log"
  local -a words
  read -ra words <<<"$missing"
  if ! { "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -qq update &&
    "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -qq install --yes --no-install-recommends "${words[@]}"; } \
    </dev/null >"$log" 2>&1; then
    tail -n 20 "$log" >&2
    say "apt-get failed; the whole log is $log"
    exit 2
  fi
}

# The stamp inside the environment holds the hash of what was asked for, so a half-made environment is made anew.
install_python() {
  local venv="$root/build/venv" wanted
  wanted=$(sha256sum <"$here/requirements.txt")
  [[ -f $venv/stamp && $(<"$venv/stamp") == "$wanted" && -x $venv/bin/python ]] && return 0
  say "installing into build/venv: $(grep -v '^#' "$here/requirements.txt" | tr '\n' ' ')"
  local log="$root/build/setup.log"
  if ! { python3 -m venv --clear "$venv" &&
    "$venv/bin/pip" install --disable-pip-version-check --quiet --requirement "$here/requirements.txt"; } >"$log" 2>&1; then
    tail -n 20 "$log" >&2
    say "the virtual environment could not be made; the whole log is $log"
    exit 2
  fi
  printf '%s\n' "$wanted" >"$venv/stamp"
}

mkdir -p "$root/build"
debian_sets=()
python=no
for set in "$@"; do
  case $set in
    build | test) debian_sets+=("$set") ;;
    python) python=yes ;;
    *)
      say "unknown set '$set'; allowed: build, test, python"
      exit 2
      ;;
  esac
done
[[ ${#debian_sets[@]} == 0 ]] || install_debian "${debian_sets[@]}"
[[ $python == no ]] || install_python
