#!/usr/bin/env bash
# Installs the dependencies: setup.sh SET... Sets:
# - `build`, `test`, `all`: Debian packages of packages.txt
# - `python`, `test-python`: PyPI packages of requirements.txt and requirements-test.txt, into the
#   virtual environment build/venv: only wheels with the SHA-256 given there
# - `mujoco`: the further releases of MuJoCo that every run of the test suite loads, into
#   build/mujoco/VERSION; `mujoco-all`: all releases in requirements-mujoco.in
# - `wheel`: requirements-wheel.txt, into build/wheel/tools
# Does nothing if all is installed. After an installation of the first two kinds, touches
# build/installed so that the launcher configures again.
# setup.sh rights SET...: installs nothing; if Debian packages are missing, sudo asks for its
# password, or the commands for root are printed.
# setup.sh missing SET...: prints the missing Debian packages, on one line.
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$here/../.." && pwd)
venv=$root/build/venv

say() { printf 'slipbench: %s\n' "$*" >&2; }

# Prints the release of Debian, such as 12.
release() { sed -n 's/^VERSION_ID="\{0,1\}\([^"]*\).*/\1/p' /etc/os-release; }

packages_of() { awk -v set="$1" -v here="$1@$(release)" '$1 == set || $1 == here { print $2 }' "$here/packages.txt"; }

# Prints the packages of a set that are not installed, on one line.
missing_of() {
  local -a wanted
  mapfile -t wanted < <(packages_of "$1")
  { dpkg-query -W -f '${Package} ${db:Status-Status}\n' "${wanted[@]}" 2>/dev/null || true; } |
    awk -v wanted="${wanted[*]}" '
      $2 == "installed" { have[$1] = 1 }
      END { n = split(wanted, names, " "); for (i = 1; i <= n; ++i) if (!(names[i] in have)) printf "%s ", names[i] }'
}

check_debian() {
  command -v dpkg-query >/dev/null && return
  say "no dpkg: the set-up supports Debian 12 and 13. Elsewhere install what tools/setup/packages.txt lists, then build with cmake --preset release."
  exit 2
}

# check_rights PACKAGES: exits with 2 if they cannot be installed. If sudo needs a password, it asks
# now.
check_rights() {
  [[ -n $1 && $(id -u) != 0 ]] || return 0
  if ! command -v sudo >/dev/null || ! { sudo -n true || : >/dev/tty; } 2>/dev/null; then
    say "Debian packages are missing, and this user is not root and has no sudo. Run this as root, then try again:"
    printf '  apt-get update && apt-get install --yes --no-install-recommends %s\n' "$1" >&2
    exit 2
  fi
  sudo -n true 2>/dev/null && return
  say "installing Debian packages with sudo: $1"
  sudo -v || exit 2
}

# install_debian SET
install_debian() {
  check_debian
  local missing
  missing=$(missing_of "$1")
  [[ -n $missing ]] || return 0
  check_rights "$missing"
  local -a as_root=() words
  [[ $(id -u) == 0 ]] || as_root=(sudo)
  say "installing Debian packages: $missing"
  read -ra words <<<"$missing"
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -q update
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -q install --yes --no-install-recommends "${words[@]}"
  touch "$root/build/installed"
}

# has_installed FILE: true if build/venv contains the packages of FILE. The stamp is the hash of
# FILE, written last, so that an interrupted installation does not count.
stamp_of() { printf '%s/%s.stamp' "$venv" "$(basename "$1" .txt)"; }
has_installed() { [[ -x $venv/bin/python && -f $(stamp_of "$1") && $(<"$(stamp_of "$1")") == "$(sha256sum <"$1")" ]]; }

# PyTorch comes from Debian. Debian's folder is last on the path of build/venv, so that packages of
# the environment have priority.
see_debian() {
  local folder
  for folder in "$venv"/lib/python3*/site-packages; do
    if [[ -d $folder ]]; then printf '/usr/lib/python3/dist-packages\n' >"$folder/debian.pth"; fi
  done
}

# install_python FILE
install_python() {
  ! has_installed "$1" || return 0
  # If a package that the program is built with changes, the environment is created anew.
  [[ $1 != */requirements.txt && -x $venv/bin/python ]] || python3 -m venv --clear "$venv"
  say "installing into build/venv: $(sed -n 's/^\([^# ]*==[^ ]*\).*/\1/p' "$1" | tr '\n' ' ')"
  "$venv/bin/pip" install --disable-pip-version-check --progress-bar off --require-hashes --only-binary :all: --requirement "$1"
  local hash
  hash=$(sha256sum <"$1")
  printf '%s\n' "$hash" >"$(stamp_of "$1")"
  touch "$root/build/installed"
}

# install_mujoco PATTERN: installs the releases of MuJoCo whose lines of requirements-mujoco.in match
# PATTERN, each in a separate folder, since an environment holds only one release.
install_mujoco() {
  local requirement folder
  local -a wanted
  mapfile -t wanted < <(awk -v pattern="$1" '/^mujoco/ && $0 ~ pattern { print $1 }' "$here/requirements-mujoco.in")
  for requirement in "${wanted[@]}"; do
    folder=$root/build/mujoco/${requirement#*==}
    [[ ! -d $folder ]] || continue
    say "installing into build/mujoco/${requirement#*==}: $requirement"
    mkdir -p "$root/build/mujoco"
    rm -rf "$folder.part"
    mkdir "$folder.part"
    "$venv/bin/pip" install --disable-pip-version-check --progress-bar off --require-hashes --only-binary :all: --no-deps --target "$folder.part" \
      --requirement <(awk -v wanted="$requirement" '!/^ / { keep = $1 == wanted } keep' "$here/requirements-mujoco.txt")
    mv "$folder.part" "$folder"
  done
}

# Installs the tools of python/build_wheels.py outside of the environment of the tests.
install_wheel_tools() {
  [[ ! -d $root/build/wheel/tools ]] || return 0
  say "installing into build/wheel/tools: $(sed -n 's/^\([^# ]*==[^ ]*\).*/\1/p' "$here/requirements-wheel.txt" | tr '\n' ' ')"
  rm -rf "$root/build/wheel/tools.part"
  "$venv/bin/pip" install --disable-pip-version-check --progress-bar off --require-hashes --only-binary :all: --target "$root/build/wheel/tools.part" \
    --requirement "$here/requirements-wheel.txt"
  mv "$root/build/wheel/tools.part" "$root/build/wheel/tools"
}

if [[ ${1:-} == rights || ${1:-} == missing ]]; then
  asked=$1
  shift
  check_debian
  missing=""
  for set in "$@"; do missing+=$(missing_of "$set"); done
  if [[ $asked == missing ]]; then
    printf '%s\n' "$missing"
  else
    check_rights "$missing"
  fi
  exit 0
fi

mkdir -p "$root/build"
for set in "$@"; do
  case $set in
    build | test | all) install_debian "$set" ;;
    python) install_python "$here/requirements.txt" ;;
    test-python)
      install_python "$here/requirements-test.txt"
      see_debian
      ;;
    wheel) install_wheel_tools ;;
    mujoco) install_mujoco '# default' ;;
    mujoco-all) install_mujoco '' ;;
    *)
      say "unknown set '$set'; allowed: build, test, all, python, test-python, mujoco, mujoco-all, wheel"
      exit 2
      ;;
  esac
done
