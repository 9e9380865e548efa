#!/bin/sh
# repose study with layers: every point measured, beds shared, runs kept.
#
#   study_test.sh REPOSE_STUDY SOURCE_TREE WORK_DIR
set -eu
study=$1 source=$2 work=$3
plan=$source/tests/layer/study.yaml
export OMP_WAIT_POLICY=passive
rm -rf -- "$work"
mkdir -p -- "$work"

fail() {
  printf 'FAILED: %s\n' "$*" >&2
  tail -n 30 -- "$work/log" >&2
  exit 1
}
run() { timeout 600 "$study" "$plan" --out "$work/out" "$@" >"$work/log" 2>&1 </dev/null || fail "exit status $?: $*"; }

run --threads 2
for file in study.json report.html; do [ -s "$work/out/$file" ] || fail "no $file"; done
for key in Sa_after packing_after thickness Sa_before sd_seed x_unit; do
  grep -q "\"$key\"" "$work/out/study.json" || fail "the study lacks $key"
done
grep -q '"not_at_rest"' "$work/out/study.json" || fail 'the study does not say what came to rest'
# Four points with two seeds; the first of `rotation` is the first of `gaps` over again.
jobs=$(ls "$work/out/jobs" | grep -c '\.json$')
[ "$jobs" = 6 ] || fail "$jobs runs were kept instead of 6"

# The same at one thread, from the beginning: the same numbers (times apart).
numbers() { grep -A 5 '"Sa_after"' "$1/study.json"; }
numbers "$work/out" >"$work/first"
rm -r -- "$work/out"
run --threads 1
numbers "$work/out" >"$work/second"
cmp -s "$work/first" "$work/second" || fail 'another number of threads, other layers'

# Taken up again, nothing is simulated.
touch "$work/mark"
run --threads 1
[ -z "$(find "$work/out/jobs" -newer "$work/mark" -name '*.json')" ] || fail 'finished runs were not used again'
