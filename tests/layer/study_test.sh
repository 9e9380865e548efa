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
for key in Sa_after packing_after thickness solid_per_area Sa_before sd_seed x_unit; do
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

# A bed that did not settle is told, and runs that did not converge are no results.
small() {
  printf 'title: bad\nscene: %s\nseeds: 1\nset: {%s}\nseries:\n  gaps: {vary: [{layer.gap: [%s]}]}\n' "$source/tests/layer/bed.yaml" "$1" "$2" >"$work/small.yaml"
  rm -rf -- "$work/small"
  status=0
  timeout 600 "$study" "$work/small.yaml" --out "$work/small" --threads 1 >"$work/log" 2>&1 </dev/null || status=$?
}
small 'layer.settle: 10 ms' '60 um'
[ "$status" = 0 ] || fail "exit status $status of a study whose bed did not settle"
grep -q '"not_at_rest": 1' "$work/small/study.json" || fail 'a bed that did not settle counts as at rest'
grep -q 'not at rest' "$work/log" || fail 'nothing tells that the bed did not settle'
# A point whose spreader cannot pass over its bed has failed; the others are measured.
small 'layer.settle: 20 ms' '60 um, -10000 um'
[ "$status" = 3 ] || fail "exit status $status instead of 3: a point that cannot be spread"
grep -q '"failed": 1' "$work/small/study.json" || fail 'a point that cannot be spread has not failed'
grep -q '"Sa_after"' "$work/small/study.json" || fail 'the other point is not measured'
grep -q 'layer.gap: the spreader would cut into the plate' "$work/log" || fail 'nothing tells why a point failed'
small 'solver.max_iterations: 2' '60 um'
[ "$status" = 3 ] || fail "exit status $status instead of 3: steps that do not converge"
grep -q '"failed": 1' "$work/small/study.json" || fail 'a run that did not converge counts as a result'
grep -q 'converged for .* of the contacts of the settling bed only' "$work/log" || fail 'nothing tells what did not converge'
