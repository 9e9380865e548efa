#!/bin/sh
# Heaps that fell through a fluid, diagnosed with a scene in a vacuum.
#
#   heap_diagnosis_test.sh FOLDER_OF_COMMANDS SCENE WORK_DIR
set -eu
commands=$1 scene=$2 work=$3
export OMP_WAIT_POLICY=passive
rm -rf -- "$work"
mkdir -p -- "$work"

fail() {
  printf 'FAILED: %s\n' "$*" >&2
  tail -n 20 -- "$work/log" >&2
  exit 1
}
# expect STATUS COMMAND ARGUMENTS...
expect() {
  wanted=$1 command=$2
  shift 2
  status=0
  timeout 300 "$commands/repose-$command" "$@" >"$work/log" 2>&1 </dev/null || status=$?
  [ "$status" = "$wanted" ] || fail "exit status $status instead of $wanted: $command $*"
}
says() { grep -qF -- "$1" "$work/log" || fail "no word of \"$1\""; }
holds() { grep -qE -- "$2" "$1" || fail "$1 does not hold $2"; }

expect 0 record "$scene" --seed 50 --out "$work/heaps"

# Wrong arguments: place and remedy, status 2.
expect 2 diagnose "$work/heaps" --out "$work/bad" --effects linear_drg
says 'linear_drag'
expect 2 diagnose "$work/heaps" --out "$work/bad" --effects wall_friction
says 'the scene has it already'

expect 0 diagnose "$work/heaps" --out "$work/found" --threads 2 --effects linear_drag,restitution
says 'verdict  missing'
holds "$work/found/diagnosis.json" '"verdict": "missing"'
holds "$work/found/diagnosis.json" '"effect": "linear_drag"'
holds "$work/found/extended.yaml" 'viscosity: '
[ -s "$work/found/report.html" ] || fail 'no report'

# The same again: every simulation is reused, and the same is found.
cp "$work/found/diagnosis.json" "$work/first.json"
before=$(find "$work/found/jobs" -newer "$work/first.json" | wc -l)
expect 0 diagnose "$work/heaps" --out "$work/found" --threads 1 --effects linear_drag,restitution
[ "$(find "$work/found/jobs" -newer "$work/first.json" | wc -l)" = "$before" ] || fail 'a simulation was made twice'
grep -v wall_s "$work/first.json" >"$work/a"
grep -v wall_s "$work/found/diagnosis.json" >"$work/b"
cmp -s "$work/a" "$work/b" || fail 'a second call found something else'

# What was recorded of the scene itself lacks nothing.
sed 's/ *conceal:.*/  conceal: {solver.time_step: 1.0e-4}/' "$scene" >"$work/plain.yaml"
expect 0 record "$work/plain.yaml" --seed 80 --out "$work/plain"
expect 0 diagnose "$work/plain" --out "$work/nothing" --threads 2
holds "$work/nothing/diagnosis.json" '"verdict": "none"'
