# shellcheck shell=bash
# Progress of the launcher, which sources this file. Everything goes to stderr.
#
# A terminal shows one line that is overwritten: step k of n, its name, its duration, the last line
# of output. A log gets a line at most every five seconds and one at the end of the step. A step
# shorter than a second prints nothing.

step=0
steps=0

say() { printf 'slipbench: %s\n' "$*" >&2; }

# Formats seconds as "12 s" or "2 min 05 s".
lasting() { if (($1 < 60)); then printf '%d s' "$1"; else printf '%d min %02d s' "$(($1 / 60))" "$(($1 % 60))"; fi; }

# show_step WHAT [LAST LINE]: prints the line of the current step.
show_step() {
  local line="slipbench: step $step of $steps: $1${2:+: $2}"
  if [[ -t 2 ]]; then
    printf '\r\033[K%s' "${line:0:$(($(tput cols 2>/dev/null || echo 80) - 1))}" >&2
  else
    printf '%s\n' "$line" >&2
  fi
}

# Announces a step whose command prints its own progress.
next_step() {
  ((++step))
  say "step $step of $steps: $1"
}

# run_step WHAT LOG COMMAND...: runs a command, with its output in LOG and its last line in the
# progress. Also prints lines of our own scripts ("slipbench: ..."). If the command fails, prints
# the end of the log and exits with 2.
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
      rest+=$line  # an incomplete line of a running command
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

# with_heartbeat COMMAND...: passes its output on, and reports each eight seconds without output.
# Returns the status of the command.
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
