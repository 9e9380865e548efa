#!/bin/sh
# repose layer as a user calls it.
#
#   layer_test.sh REPOSE_LAYER SOURCE_TREE WORK_DIR
set -eu
layer=$1 source=$2 work=$3
bed=$source/tests/layer/bed.yaml
. "$source/tests/layer/in_json.sh"
export OMP_WAIT_POLICY=passive
rm -rf -- "$work"
mkdir -p -- "$work"

fail() {
  printf 'FAILED: %s\n' "$*" >&2
  tail -n 20 -- "$work/log" >&2
  exit 1
}
# expect STATUS ARGUMENTS...: the command with its output in $work/log, its beds in $beds.
expect() {
  wanted=$1
  shift
  status=0
  timeout 400 "$layer" "$@" --beds "${beds:-$work/beds}" >"$work/log" 2>&1 </dev/null || status=$?
  [ "$status" = "$wanted" ] || fail "exit status $status instead of $wanted: $*"
}
# start ARGUMENTS...: in the background, as $process, until `interrupt`.
start() {
  "$layer" "$@" --beds "$work/beds" >"$work/log" 2>&1 </dev/null &
  process=$!
}
interrupt() {
  kill -INT "$process" 2>/dev/null || fail 'it ended before it could be interrupted'
  status=0
  wait "$process" || status=$?
  [ "$status" = 130 ] || fail "exit status $status instead of 130"
}
says() { grep -qF -- "$1" "$work/log" || fail "no word of \"$1\""; }

# Wrong scenes: place and remedy, before anything settles.
expect 2 "$source/scenarios/configs/block_on_incline.yaml" --out "$work/bad"
says 'no `layer` block'
expect 2 "$bed" --out "$work/bad" --set 'layer.sides.y=[-0.1 mm, 0.1 mm]'
says 'the region reaches beyond these sides'
expect 2 "$bed" --out "$work/bad" --set layer.sides.kind=cyclic
says 'periodic'
expect 2 "$bed" --out "$work/bad" --set layer.spreader=roler
says 'roller'
[ ! -e "$work/bad/result.json" ] || fail 'a refused layer has a result'
[ ! -e "$work/beds" ] || fail 'a refused layer has a bed'

# A bed is made, and all files are there.
expect 0 "$bed" --out "$work/one" --quiet --threads 1
says 'settled now'
for file in result.json run.h5 surface.vdb surface.png report.html; do [ -s "$work/one/$file" ] || fail "no $file"; done
for key in before after Sa Sq Sp Sv Sz Ssk Sku packing_fraction solid_per_area roller force torque; do
  grep -q "\"$key\"" "$work/one/result.json" || fail "the result lacks $key"
done

# A run that begins anew takes away what an earlier one left, before its bed settles: also with --resume where there is no checkpoint.
for resume in '' --resume; do
  mkdir -p "$work/stale"
  for file in result.json report.html surface.png surface.vdb; do : >"$work/stale/$file"; done
  start "$bed" --out "$work/stale" --quiet $resume --set solver.tolerance=1e-9
  while [ -e "$work/stale/result.json" ] && kill -0 "$process" 2>/dev/null; do sleep 0.05; done
  interrupt
  says 'interrupted while the bed settled'
  for file in result.json report.html surface.png surface.vdb; do [ ! -e "$work/stale/$file" ] || fail "$file of an earlier run stays${resume:+ with $resume}"; done
done

# Half the step, beside all that there was.
expect 0 "$bed" --out "$work/half" --quiet --threads 1 --half-step
says 'half the step'
cmp -s "$work/one/run.h5" "$work/half/run.h5" || fail '--half-step changes run.h5'
whole=$(in_json "$work/half/result.json" half_step/figures/Sa/value 0) half=$(in_json "$work/half/result.json" half_step/figures/Sa/half_step 0)
awk -v a="$whole" -v b="$half" 'BEGIN { exit !(a > 0 && b > 0 && a != b && b < 2 * a && a < 2 * b) }' || fail "Sa is $whole with the step and $half with half of it"
grep -q 'Convergence in the step' "$work/half/report.html" || fail 'the report does not show half the step'

# It is used again, and gives the same bytes.
expect 0 "$bed" --out "$work/two" --quiet --threads 2
says 'reused'
cmp -s "$work/one/run.h5" "$work/two/run.h5" || fail 'the same bed, another run.h5'
for file in surface.png surface.vdb; do cmp -s "$work/one/$file" "$work/two/$file" || fail "the same bed, another $file"; done
without_times() { grep -vE '"(wall_s|bed_wall_s|peak_memory_bytes)"' "$1/result.json"; }
[ "$(without_times "$work/one")" = "$(without_times "$work/two")" ] || fail 'the same layer over the same bed, another result'

# Interrupted while it spreads and taken up again, too.
start "$bed" --out "$work/resumed" --quiet --checkpoint-interval 0.05
while [ ! -e "$work/resumed/frames/frame-000001.h5" ] && kill -0 "$process" 2>/dev/null; do sleep 0.02; done
interrupt
[ ! -e "$work/resumed/result.json" ] || fail 'an interrupted layer has a result'
expect 0 "$bed" --out "$work/resumed" --quiet --resume
cmp -s "$work/one/run.h5" "$work/resumed/run.h5" || fail 'interrupted and resumed, another run.h5'
for file in surface.png surface.vdb; do cmp -s "$work/one/$file" "$work/resumed/$file" || fail "interrupted and resumed, another $file"; done

# From 500 bodies and 1,000 contacts on the work is shared among the threads: the same bytes, bed and spreading.
for threads in 1 2; do
  beds=$work/beds_$threads
  expect 0 "$bed" --out "$work/many_$threads" --quiet --threads $threads --set grains.bed.count=500 --set layer.settle=30ms --set layer.to=0.3mm \
    --set layer.rest=2ms --set solver.tolerance=0.03
done
beds=
cmp -s "$work/many_1/run.h5" "$work/many_2/run.h5" || fail 'another number of threads, another run.h5'
for file in surface.png surface.vdb; do cmp -s "$work/many_1/$file" "$work/many_2/$file" || fail "another number of threads, another $file"; done
grep -qE '"contacts_mean": [1-9][0-9]{3}' "$work/many_1/result.json" || fail 'too few contacts for two threads'

# Measured while grains still move, which is told.
grep -q '^  "at_rest": true' "$work/one/result.json" || fail 'the layer did not come to rest'
expect 0 "$bed" --out "$work/moving" --quiet --set 'layer.rest=0 s'
says 'make layer.rest longer'
grep -q '^  "at_rest": false' "$work/moving/result.json" || fail 'a layer that moves is at rest'
grep -qF 'make layer.rest longer' "$work/moving/report.html" || fail 'the report does not tell that the layer moves'

# A roller held down by a load: one that the powder never lifts spreads as the rigid one does; a light one rides on the grains.
expect 0 "$bed" --out "$work/heavy" --quiet --set 'tools.roller.yield={load: 5 uN, mass: 1 ug}'
says 'rise             0 um in the mean'
cmp -s "$work/one/surface.png" "$work/heavy/surface.png" || fail 'a load that is never lifted changes the surface'
expect 0 "$bed" --out "$work/light" --quiet --set 'tools.roller.yield={load: 0.02 uN, mass: 1 ug}'
grep -qE 'rise             [1-9][0-9.]* um in the mean' "$work/log" || fail 'a light roller does not rise'
grep -qF 'Rise of the spreader' "$work/light/report.html" || fail 'the report does not tell of the rise'
expect 2 "$bed" --out "$work/bad" --set 'tools.roller.yield={load: 0.02 uN}'
says 'key `mass` is missing'

# The bed serves other spreaders too: of another material, at another speed, a gap above the plate, a blade. Another plate is another bed.
expect 0 "$bed" --out "$work/other" --quiet --set pairs.pa12-steel.friction=0.5 --set effects.moving_wall_speed.factor=1.5 --set layer.gap_from=plate \
  --set 'layer.gap=380 um'
says 'reused'
says 'lowest line 380.0 um above the plate'
grep -q '"speed": 0.1905' "$work/other/result.json" || fail 'the spreader is not as fast as the effect makes it'
expect 0 "$bed" --out "$work/other" --quiet --set 'layer.plate=10 um'
says 'settled now'

# number RUN PATH [COMPONENT]: of its result; of a vector, the component.
number() { in_json "$work/$1/result.json" "$2" "${3:-0}"; }
holds() { awk "BEGIN { exit !($1) }" || fail "not so: $1 ($2)"; }
pushed_back() {
  holds "$(number "$1" roller/force 1) < 0 && $(number "$1" roller/force 3) > 0" "the powder resists and bears $1"
  holds "$(number "$1" spreader/p99_above_lowest) < 1e-6 && $(number "$1" mass/grains_moved_in) > 0" "powder is spread, none higher than $1"
}
pushed_back one
for rake in 0 30 -30; do
  expect 0 "$bed" --out "$work/blade" --quiet --set layer.spreader=blade --set \
    "tools.blade={material: steel, position: [-3 mm, 0, 1.5 mm], thickness: 0.2 mm, height: 1 mm, width: 0.75 mm, rake_deg: $rake, edge_radius: 20 um}"
  says 'reused'
  says 'spreader         lowest line 388.7 um above the plate, 60.0 um above the mean surface'
  pushed_back blade
done
grep -qF 'About the centre of the blade' "$work/blade/report.html" || fail 'the report does not say what the torque refers to'

# What stands in the way, be it a tool or a fixed body, is not passed through.
expect 2 "$bed" --out "$work/bad" --set 'shapes.block={type: box, half_extents: [20 um, 20 um, 0.2 mm]}' --set \
  'bodies.post={shape: block, material: steel, position: [0.55 mm, 0, 0.6 mm], fixed: true}'
says 'cuts into `post`'

# Grains that jam between roller and plate: told before the run, after it and in the result; steps in which they overlap tell no force.
low() { printf 'tools.%s.position=[%s mm, 0, 1 um]' "$1" "$2"; }
expect 0 "$bed" --out "$work/jam" --quiet --set "$(low near_end -0.45)" --set "$(low far_end 0.45)" --set "$(low catch_near -0.95)" --set "$(low catch_far 0.95)" \
  --set grains.bed.count=60 --set grains.pile.count=20 --set layer.gap_from=plate --set 'layer.gap=60 um'
says 'warning: layer.gap: the spreader passes 60 um above the plate, over grains of up to 100 um'
says 'warning: layer.gap: grains overlapped by up to'
says 'others overlapped deeper than'
grep -q 'grains overlapped by up to' "$work/jam/result.json" || fail 'the result does not tell that grains overlapped'
grep -qF 'grains overlapped by up to' "$work/jam/report.html" || fail 'the report does not tell that grains overlapped'
holds "$(number jam roller/used_steps) < $(number jam roller/converged_steps)" 'steps with overlap tell no force'
holds "$(number one roller/used_steps) == $(number one roller/steps)" 'all steps without overlap tell the force'
