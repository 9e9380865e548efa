#!/bin/sh
# A recording of a world that has more than the scene that goes with it, diagnosed: the truth runs at a finer step.
#
#   diagnosis_test.sh CASE BIN_DIR CHECK SOURCE_TREE WORK_DIR
set -eu
case=$1 bin=$2 check=$3 source=$4 work=$5/$1
export OMP_WAIT_POLICY=passive
rm -rf -- "$work"
mkdir -p -- "$work"

# Records a scene with what is given by --set.
record() { "$bin/repose-record" "$@" --seed 3 --quiet --out "$work/bundle" >"$work/log" 2>&1 || { cat "$work/log" >&2; exit 1; }; }
diagnose() {
  "$bin/repose-diagnose" "$work/bundle" --replicas 199 --threads 1 --quiet --out "$work/out" "$@" >"$work/log" 2>&1 || { cat "$work/log" >&2; exit 1; }
}
finer=', solver.time_step: 5.0e-4, solver.tolerance: 1.0e-7'

case $case in
  drag)
    record "$source/tests/diagnosis/thrown.yaml" --set "record.conceal={effects.quadratic_drag: {coefficient: 0.47, fluid_density: 1.2}$finer}"
    diagnose
    "$check" "$work/out" "$work/bundle" missing quadratic_drag effects.quadratic_drag.coefficient 0.47
    ;;
  nothing)
    # Runs are recorded side by side: how many at once must not show.
    record "$source/tests/diagnosis/thrown.yaml" --threads 1
    mv -- "$work/bundle" "$work/one_by_one"
    record "$source/tests/diagnosis/thrown.yaml" --threads 3
    diff -r "$work/one_by_one" "$work/bundle"
    diagnose
    "$check" "$work/out" "$work/bundle" none
    ;;
  ruler)
    record "$source/tests/diagnosis/thrown.yaml"
    # A ruler that reads 3 % too much.
    for file in "$work"/bundle/*.csv; do
      awk -F, 'BEGIN { OFS = "," } NR > 1 { for (i = 3; i <= 5; ++i) $i = sprintf("%.9g", 1.03 * $i) } { print }' "$file" >"$file.scaled"
      mv -- "$file.scaled" "$file"
    done
    diagnose
    "$check" "$work/out" "$work/bundle" measurement length_scale length_scale.factor 1.03
    ;;
  interrupted)
    # Ctrl-C leaves what was found, says how to go on, and the same command then gives what it would have given.
    record "$source/tests/diagnosis/thrown.yaml" --set "record.conceal={effects.quadratic_drag: {coefficient: 0.47, fluid_density: 1.2}$finer}"
    diagnose --one-engine
    mv -- "$work/out" "$work/whole"
    "$bin/repose-diagnose" "$work/bundle" --replicas 199 --threads 1 --one-engine --out "$work/out" >"$work/log" 2>&1 &
    running=$!
    # Once it is at work: progress is told from then on.
    until grep -q simulations "$work/log"; do sleep 0.05; done
    kill -INT $running
    status=0
    wait $running || status=$?
    [ $status -eq 130 ] || { cat "$work/log" >&2; echo "status $status instead of 130" >&2; exit 1; }
    [ ! -e "$work/out/diagnosis.json" ]
    grep -q -- "--replicas 199" "$work/log"
    grep -q -- "--one-engine" "$work/log"
    diagnose --one-engine
    for run in whole out; do sed -E '/"wall_s"|"simulations"/d' "$work/$run/diagnosis.json" >"$work/$run.json"; done
    cmp -- "$work/whole.json" "$work/out.json"
    # Options that take a list do not swallow the bundle.
    "$bin/repose-diagnose" --candidates quadratic_drag "$work/bundle" --replicas 199 --threads 1 --one-engine --quiet --out "$work/listed" >"$work/log" 2>&1
    # A scene that no grains can be is refused, unless it is meant so.
    status=0
    "$bin/repose-diagnose" "$work/bundle" --replicas 199 --threads 1 --one-engine --quiet --out "$work/absurd" --set materials.foam.density=0.05 >"$work/log" 2>&1 || status=$?
    [ $status -eq 2 ] || { cat "$work/log" >&2; echo "status $status instead of 2" >&2; exit 1; }
    grep -q -- "--force" "$work/log"
    # What is wrong with a bundle ends with status 2.
    sed -i 's/^0,/x,/' "$work/bundle"/*.csv
    status=0
    "$bin/repose-diagnose" "$work/bundle" --out "$work/bad" >"$work/log" 2>&1 || status=$?
    [ $status -eq 2 ] || { cat "$work/log" >&2; echo "status $status instead of 2" >&2; exit 1; }
    ;;
  layer)
    # Grains by the hundred: surfaces and loads against the scatter of packings.
    record "$source/scenarios/configs/concealed_layer.yaml" --set "record.runs=[{id: a}, {id: b}, {id: c}, {id: d}, {id: e}, {id: f}]"
    diagnose --candidates cohesion --candidates grain_shape
    "$check" "$work/out" "$work/bundle" missing cohesion pairs.pa12-pa12.cohesion 30e-9
    ;;
esac
