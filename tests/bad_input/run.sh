#!/usr/bin/env bash
# Malformed and absurd input, each beside a good twin (cases.sh). Usage: run.sh BIN_DIR [NAME...]
#
# The bad one must end with status 2 or 3, with a message that names the place and the remedy, without a crash or a hang;
# its twin must end with status 0. BIN_DIR holds repose-check and, for the cases of runs.sh, repose-run.
set -u
here=$(cd "$(dirname "$0")" && pwd)
bin=$(cd "${1:?usage: run.sh BIN_DIR [NAME...]}" && pwd)
shift
only=" $* "
work=$(mktemp -d)
trap 'chmod -R u+w "$work"; rm -rf "$work"' EXIT
cp "$here"/*.yaml "$here"/*.obj "$here/../layer/bed.yaml" "$work"
cd "$work" || exit 1

bad=0 twins=0 failures=0

wanted() { [[ $only == "  " || $only == *" $1 "* ]]; }

complain() {
  failures=$((failures + 1))
  printf 'FAILED %s: %s\n' "$1" "$2"
  sed 's/^/    | /' "$work/output"
}

# launch COMMAND...: output and exit status; no run may take longer than a minute.
launch() {
  timeout -k 5 60 "$@" >"$work/output" 2>&1 </dev/null
  status=$?
}

# refuses NAME PLACE REMEDY COMMAND...
refuses() {
  local name=$1 place=$2 remedy=$3
  shift 3
  bad=$((bad + 1))
  launch "$@"
  if [[ $status -ne 2 && $status -ne 3 ]]; then complain "$name" "exit status $status instead of 2 or 3"; return; fi
  grep -qF -- "$place" "$work/output" || complain "$name" "the message does not name \"$place\""
  grep -qF -- "$remedy" "$work/output" || complain "$name" "the message does not say \"$remedy\""
  ! grep -qE 'terminate called|Sanitizer|Assertion|runtime error|internal error' "$work/output" ||
    complain "$name" "a crash report instead of a message"
}

# accepts NAME COMMAND...
accepts() {
  local name=$1
  shift
  twins=$((twins + 1))
  launch "$@"
  [[ $status -eq 0 ]] || complain "$name" "the good twin ends with exit status $status"
}

# edit NAME BASE FROM BAD MENDED PLACE REMEDY: see cases.sh.
edit() {
  wanted "$1" || return 0
  local name=$1 from=$3 spoilt=$4 mended=$5 place=$6 remedy=$7 text
  text=$(cat "$2")
  if [[ $text != *"$from"* ]]; then
    echo "" >"$work/output"
    complain "$name" "$2 does not hold \"$from\""
    return
  fi
  printf '%s\n' "${text/"$from"/"$spoilt"}" >"$name.bad.yaml"
  printf '%s\n' "${text/"$from"/"${mended:-$from}"}" >"$name.good.yaml"
  refuses "$name" "$place" "$remedy" "$bin/repose-check" "$name.bad.yaml"
  accepts "$name" "$bin/repose-check" "$name.good.yaml"
}

# text NAME TEXT PLACE REMEDY: a file that holds TEXT; its twin is bodies.yaml.
text() {
  wanted "$1" || return 0
  printf '%s' "$2" >"$1.bad.yaml"
  refuses "$1" "$3" "$4" "$bin/repose-check" "$1.bad.yaml"
  accepts "$1" "$bin/repose-check" bodies.yaml
}

# shellcheck source=cases.sh
. "$here/cases.sh"
# shellcheck source=runs.sh
. "$here/runs.sh"

echo "$bad bad inputs, $twins good twins, $failures failures"
[[ $failures -eq 0 && $bad -gt 0 ]]
