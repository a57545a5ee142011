#!/usr/bin/env bash
# Runs a command as on a new machine: a bare Debian or Ubuntu with only apt and certificates, in a
# fresh clone of HEAD. With `./slipbench demo`, it shows which packages packages.txt lacks.
#   tools/setup/bare_debian.sh [-r bookworm|trixie|noble] [-d FOLDER] COMMAND...
# -r: release; default bookworm, Debian 12; noble is Ubuntu 24.04 and needs Ubuntu's package
# ubuntu-keyring. -d: keeps system and clone in FOLDER; default: deletes.
# Needs root and Debian's mmdebstrap; exits with 3 if no such system can be created. The system is a
# chroot of 150 MB, created in 20 s.
set -euo pipefail

usage() { printf 'slipbench: %s\n' "$1" >&2; sed -n '2,8s/^# \{0,1\}//p' "$0" >&2; exit 2; }
no_system() { printf 'slipbench: no bare Debian can be made here: %s\n' "$1" >&2; exit 3; }

release=bookworm
folder=""
while getopts r:d: option; do
  case $option in
    r) release=$OPTARG ;;
    d) folder=$OPTARG ;;
    *) usage "allowed: -r, -d" ;;
  esac
done
shift $((OPTIND - 1))
[[ $release =~ ^(bookworm|trixie|noble)$ ]] || usage "-r $release; allowed: bookworm, trixie, noble"
[[ $# -gt 0 ]] || usage "no command; allowed: one, with its words"

[[ $(id -u) == 0 ]] || no_system "not root"
command -v mmdebstrap >/dev/null || no_system "no mmdebstrap; get it with: apt-get install --yes mmdebstrap"
keyring=/usr/share/keyrings/debian-archive-keyring.gpg
get_keyring="apt-get install --yes debian-archive-keyring"
if [[ $release == noble ]]; then
  keyring=/usr/share/keyrings/ubuntu-archive-keyring.gpg
  get_keyring="dpkg --install ubuntu-keyring_*.deb, from https://packages.ubuntu.com/noble/ubuntu-keyring"
fi
unshare --mount true 2>/dev/null || no_system "no right to mount"
[[ -e $keyring ]] || no_system "no $keyring; get it with: $get_keyring"

tree=$(git -C "$(dirname "${BASH_SOURCE[0]}")" rev-parse --show-toplevel)
base=$folder
[[ -n $base ]] || base=$(mktemp -d)
mkdir -p "$base"
base=$(realpath "$base")
root=$base/root
[[ ! -e $root || -e $root/tree ]] || usage "-d $folder: $root is there and is no system of this script; allowed: another folder"
[[ ! -e $root ]] || grep -q "^VERSION_CODENAME=$release$" "$root/etc/os-release" || usage "-r $release: $root is of another release"
# Uses a separate mount namespace: the mounts disappear with this process, however it ends, before
# the files are removed.
if [[ -z ${SLIPBENCH_BARE_DEBIAN:-} ]]; then
  [[ -n $folder ]] || trap 'rm -rf --one-file-system "$base"' EXIT
  SLIPBENCH_BARE_DEBIAN=1 unshare --mount --propagation private "${BASH_SOURCE[0]}" -r "$release" -d "$base" "$@"
  exit
fi

# Copies this machine's mirror, proxies and certificates: access to packages is not under test.
if [[ ! -e $root ]]; then
  made=$root
  root=$base/root.part
  rm -rf --one-file-system "$root"
  mkdir "$root"
  # shellcheck disable=SC2016  # apt-get expands it
  mirror=$(apt-get indextargets --format '$(REPO_URI)' 2>/dev/null | grep -m 1 '/debian/*$' || echo http://deb.debian.org/debian)
  parts=main
  security="${mirror%/}-security"
  if [[ $release == noble ]]; then
    mirror=http://archive.ubuntu.com/ubuntu
    security=$mirror
    parts="main universe"
  fi
  mmdebstrap --quiet --variant=apt --include=ca-certificates "$release" "$root" \
    "deb [signed-by=$keyring] $mirror $release $parts" "deb [signed-by=$keyring] $mirror $release-updates $parts" \
    "deb [signed-by=$keyring] $security $release-security $parts"
  for setting in /etc/apt/apt.conf.d /etc/apt/preferences.d /etc/pip.conf /etc/hosts /etc/resolv.conf /usr/local/share/ca-certificates /etc/ssl/certs \
                 ${PIP_FIND_LINKS:-}; do
    [[ -e $setting ]] || continue
    rm -rf "${root:?}$setting"
    mkdir -p "$(dirname "$root$setting")"
    cp -aL "$setting" "$root$setting"
  done
  git clone --quiet "$tree" "$root/tree"
  mv "$root" "$made"
  root=$made
fi
mount --bind "$root" "$root"  # unshare requires its root to be a mount point: allows a system inside this one
mount -t proc proc "$root/proc"
mount --rbind /sys "$root/sys"
mount --rbind /dev "$root/dev"
settings=()
while IFS= read -r -d '' pair; do settings+=("$pair"); done \
  < <(env -0 | grep -zE '^(CI|PIP_[A-Z_]*|SSL_CERT_[A-Z]*|REQUESTS_CA_BUNDLE|(https?|no)_proxy|(HTTPS?|NO)_PROXY)=' || true)
# shellcheck disable=SC2016  # expanded by the shell in the chroot
chroot "$root" /usr/bin/env -i "${settings[@]}" HOME=/root TERM="${TERM:-dumb}" LANG=C.UTF-8 \
  PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin sh -c 'cd /tree && exec "$@"' sh "$@"
