# shellcheck shell=bash
# How the launcher tells what it does: sourced by it. Everything goes to stderr.
#
# A terminal shows one line that is written over: step k of n, what is done, for how long, what the command said last. A log gets a plain line
# at a step's begin, one at least every five seconds while it lasts, and one at its end. A step of less than a second says nothing.

step=0
steps=0

say() { printf 'slipbench: %s\n' "$*" >&2; }

# A number of seconds as people write it.
lasting() { if (($1 < 60)); then printf '%d s' "$1"; else printf '%d min %02d s' "$(($1 / 60))" "$(($1 % 60))"; fi; }

# The line of the step at hand: show_step WHAT [LAST WORDS]
show_step() {
  local line="slipbench: step $step of $steps: $1${2:+: $2}"
  if [[ -t 2 ]]; then
    printf '\r\033[K%s' "${line:0:$(($(tput cols 2>/dev/null || echo 80) - 1))}" >&2
  else
    printf '%s\n' "$line" >&2
  fi
}

# Announces a step whose command speaks for itself.
next_step() {
  ((++step))
  say "step $step of $steps: $1"
}

# run_step WHAT LOG COMMAND...: runs a command, with its output in LOG and its last line in the progress. What our own scripts say in it
# ("slipbench: ...") is shown whole. Exits with 2 and the end of the log when it fails.
run_step() {
  local what=$1 log=$2 started=$SECONDS shown=-1 status=1 line rest="" last="" fd
  shift 2
  ((++step))
  : >"$log"
  exec {fd}< <(status=0; "$@" </dev/null 2>&1 || status=$?; printf '\n\036%d\n' "$status")
  while :; do
    if IFS= read -r -t 1 -u "$fd" line; then
      line=$rest$line
      rest=""
      if [[ $line == $'\036'* ]]; then
        status=${line:1}
        break
      fi
      printf '%s\n' "$line" >>"$log"
      [[ -z $line ]] || last=$line
      if [[ $line == 'slipbench: '* ]]; then
        [[ ! -t 2 ]] || printf '\r\033[K' >&2
        printf '%s\n' "$line" >&2
      fi
    elif (($? > 128)); then
      rest+=$line  # a part of a line, of a command that has not come to its end yet
    else
      break
    fi
    local lasts=$((SECONDS - started))
    if ((lasts >= 1)) && { ((shown < 0)) || [[ -t 2 ]] || ((SECONDS - shown >= 5)); }; then
      show_step "$what" "$(lasting "$lasts"), $last"
      shown=$SECONDS
    fi
  done
  exec {fd}<&-
  if [[ $status != 0 ]]; then
    [[ $shown == -1 || ! -t 2 ]] || printf '\n' >&2
    tail -n 40 "$log" >&2
    say "failed: $what; the whole log is $log"
    exit 2
  fi
  ((shown < 0)) || { show_step "$what" "done in $(lasting "$((SECONDS - started))")"; [[ ! -t 2 ]] || printf '\n' >&2; }
}

# with_heartbeat COMMAND...: its output as it is, and a line where it says nothing for eight seconds. Its exit status is the command's.
with_heartbeat() {
  local started=$SECONDS line rest=""
  "$@" | while :; do
    if IFS= read -r -t 8 line; then
      printf '%s\n' "$rest$line"
      rest=""
    elif (($? > 128)); then
      rest+=$line
      say "running for $(lasting "$((SECONDS - started))")"
    else
      printf '%s' "$rest$line"
      break
    fi
  done
}
