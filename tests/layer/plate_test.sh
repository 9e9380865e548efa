#!/bin/sh
# repose layer on a bare plate, as a user calls it: figures where grains lie beside plate, and none where nothing lies.
#
#   plate_test.sh REPOSE_LAYER SOURCE_TREE WORK_DIR
set -eu
layer=$1 source=$2 work=$3
plate=$source/scenarios/configs/layer_plate.yaml
export OMP_WAIT_POLICY=passive
rm -rf -- "$work"
mkdir -p -- "$work"

fail() {
  printf 'FAILED: %s\n' "$*" >&2
  tail -n 20 -- "$work/log" >&2
  exit 1
}
# expect STATUS ARGUMENTS...: the command with its output in $work/log. A coarser tolerance: a test of figures, not of grains.
expect() {
  wanted=$1
  shift
  status=0
  timeout 300 "$layer" "$plate" --quiet --threads 1 --beds "$work/beds" --set solver.tolerance=1e-2 "$@" >"$work/log" 2>&1 </dev/null || status=$?
  [ "$status" = "$wanted" ] || fail "exit status $status instead of $wanted: $*"
}
says() { grep -qF -- "$1" "$work/log" || fail "no word of \"$1\""; }
# number FILE PATH...: what stands there in the indented JSON.
number() {
  file=$1
  shift
  want=$(printf '.%s' "$@")
  awk -v want="$want" '
    match($0, /^ *"[^"]*": /) {
      depth = (index($0, "\"") - 1) / 2
      key[depth] = substr($0, 2 * depth + 2, RLENGTH - 2 * depth - 4)
      path = ""
      for (k = 1; k <= depth; ++k) path = path "." key[k]
      if (path != want) next
      value = substr($0, RLENGTH + 1)
      sub(/,$/, "", value)
      print value
      exit
    }' "$file"
}
# holds EXPRESSION: of awk, without variables.
holds() { awk "BEGIN { exit !($1) }" || fail "not so: $1"; }

expect 0 --out "$work/one"
says 'bare plate'
says 'of the gap'
result=$work/one/result.json
before() { number "$result" surface before "$1"; }
after() { number "$result" surface after "$1"; }
for key in mean sd min max Sa Sq Sp Sv Sz coverage; do holds "$(before $key) == 0"; done
for key in Ssk Sku Sal; do [ "$(before $key)" = null ] || fail "$key of a bare plate is $(before $key)"; done
[ "$(number "$result" packing_fraction before)" = null ] || fail 'a bare plate has a packing fraction'
# What came is above the plate, below the spreader, and as thick as the surface after is high.
holds "$(after coverage) > 0.2 && $(after coverage) < 1"
holds "$(after min) == 0 && $(after max) > 50e-6 && $(after max) < 115e-6"
holds "$(number "$result" thickness mean) == $(after mean) && $(after mean) > 0"
holds "$(number "$result" thickness se) > 0"
holds "$(number "$result" packing solid_per_area) > 0 && $(number "$result" packing solid_per_area) < $(after mean)"
holds "$(number "$result" packing solid_of_gap) > 0.05 && $(number "$result" packing solid_of_gap) < 0.6"
holds "$(number "$result" spreader lowest_above_plate) > 109.9e-6 && $(number "$result" spreader lowest_above_plate) < 110.1e-6"
grep -qF 'before: bare plate' "$work/one/report.html" || fail 'the report does not tell that the plate was bare'
grep -qiE '>(nan|inf)|null µm' "$work/one/report.html" && fail 'the report tells what is no number'

# The gap from the mean surface of a bare plate is that from the plate: the same surface.
expect 0 --out "$work/two" --set layer.gap_from=bed
says 'reused'
cmp -s "$work/one/surface.png" "$work/two/surface.png" || fail 'the gap does not count from the plate'

# No powder where it is measured: told, and no failure after all the work.
expect 0 --out "$work/none" --set 'layer.from=-6 mm' --set 'layer.to=-5.5 mm'
says 'warning: no grain lies over the region'
holds "$(number "$work/none/result.json" surface after coverage) == 0 && $(number "$work/none/result.json" thickness mean) == 0"

# Beside the plate there is no surface; refused before anything is spread.
expect 2 --out "$work/beside" --set 'layer.region.upper=[1.6 mm, 0.2 mm]'
says 'no fixed solid has its top at layer.plate'
[ ! -e "$work/beside/result.json" ] || fail 'a region beside the plate has a result'
# Filters that the grid cannot hold.
expect 2 --out "$work/beside" --set layer.surface.l_filter=10um
says 'shorter than three cells'
