#!/bin/sh
# repose study with layers: every point measured, beds shared, runs kept.
#
#   study_test.sh REPOSE_STUDY SOURCE_TREE WORK_DIR REPOSE_LAYER
set -eu
study=$1 source=$2 work=$3 layer=$4
plan=$source/tests/layer/study.yaml
. "$source/tests/layer/in_json.sh"
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
for key in Sa_after packing_after thickness solid_per_area Sa_before sd_seed x_unit min_centres_before p0.1_tops_before p99.9_centres_after max_tops_after sd_tops_100um_after; do
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
# A point is what `repose layer` gives of the same scene and seed: surfaces, highest grains, and the load on the roller.
small 'layer.settle: 100 ms' '60 um'
[ "$status" = 0 ] || fail "exit status $status of a study of one layer"
timeout 600 "$layer" "$source/tests/layer/bed.yaml" --seed 1 --out "$work/layer" --beds "$work/beds" --quiet >"$work/log" 2>&1 </dev/null || fail 'no layer'
of_study() { in_json "$(ls "$work"/small/jobs/*.json)" "observables/$1" 0; }
while read -r name path below; do
  expected=$(in_json "$work/layer/result.json" "$path" "$below")
  [ -n "$expected" ] && [ "$(of_study "$name")" = "$expected" ] || fail "$name is $(of_study "$name") in the study and $expected in the layer"
done <<'END'
Sa_after surface/after/Sa 0
Sa_before surface/before/Sa 0
packing_after packing_fraction/after 0
force_along roller/force 1
force_up roller/force 3
torque roller/torque 2
force_largest roller/largest_force 0
max_centres_after surface/after/highest_grains/centre/max 0
p99.9_tops_before surface/before/highest_grains/top/quantiles_percent/99.9 0
END
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
