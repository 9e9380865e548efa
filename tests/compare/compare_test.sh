#!/bin/sh
# repose compare as a user calls it.
#
#   compare_test.sh REPOSE_COMPARE SOURCE_TREE WORK_DIR
set -eu
compare=$1 source=$2 work=$3
heap=$source/tests/bad_input/heap.yaml
incline=$source/scenarios/configs/block_on_incline.yaml
export OMP_WAIT_POLICY=passive
rm -rf -- "$work"
mkdir -p -- "$work"

fail() {
  printf 'FAILED: %s\n' "$*" >&2
  tail -n 20 -- "$work/log" >&2
  exit 1
}
# expect STATUS ARGUMENTS...: the command with its output in $work/log.
expect() {
  wanted=$1
  shift
  status=0
  timeout 120 "$compare" "$@" >"$work/log" 2>&1 </dev/null || status=$?
  [ "$status" = "$wanted" ] || fail "exit status $status instead of $wanted: $*"
}
says() { grep -qF -- "$1" "$work/log" || fail "no word of \"$1\""; }
holds() { grep -qE -- "$2" "$1" || fail "$1 does not hold $2"; }

# Wrong arguments: place and remedy, status 2.
expect 2 "$heap" --out "$work/bad" --backends dvi,bulet
says '--backends'
says 'known backends'
expect 2 "$heap" --out "$work/bad" --backends dvi
says 'name two or more'
expect 2 "$heap" --out "$work/bad" --seeds 1
says '--seeds'
expect 2 "$heap" --out "$work/bad" --seeds 0
expect 2 "$heap" --out "$work/bad" --preset cubes
says 'spheres, shapes'
expect 2 "$work/absent.yaml" --out "$work/bad"
says 'absent.yaml'
expect 2 "$heap" --out "$work/bad" --set grains.powder.siez=1
[ ! -e "$work/bad/compare.json" ] || fail 'a refused comparison has a result'

# Physics that a backend lacks: refused by name, left out only when asked, and listed.
slip='effects.rate_dependent_friction={slope: 0.02, reference_speed: 0.1}'
expect 2 "$heap" --out "$work/bad" --backends dvi,bullet --set "$slip"
says 'this backend cannot do: rate_dependent_friction'
says '--allow-unsupported'
expect 0 "$heap" --out "$work/lacking" --backends dvi,bullet --seeds 2 --no-refine --set "$slip" --allow-unsupported
says 'bullet leaves out rate_dependent_friction'
[ "$(grep -A 1 '"unsupported": \[' "$work/lacking/compare.json" | grep -c rate_dependent_friction)" = 1 ] || fail 'the result does not list what one backend lacks'

# A scene without grains: nothing random, the tolerance decides.
expect 0 "$incline" --out "$work/incline" --quiet --backends dvi,bullet
says 'agree about all'
holds "$work/incline/compare.json" '"name": "block.x"'

# Grains on two backends, refined.
expect 0 "$heap" --out "$work/heap" --quiet --backends dvi,bullet --seeds 4 --threads 2
for key in backends observables verdict standard_errors partings headline; do holds "$work/heap/compare.json" "\"$key\""; done
holds "$work/heap/compare.json" '"half_step"'
holds "$work/heap/report.html" 'chart-data'
[ "$(ls "$work/heap/jobs" | wc -l)" = 24 ] || fail 'not 24 runs: 2 backends, 3 refinements, 4 seeds'

# Each seed makes its own grains, here of a mean size that makes four rings or five of them: all films have the same cells.
expect 0 "$heap" --out "$work/cells" --quiet --backends dvi,bullet --seeds 6 --no-refine --set tools.base.diameter=0.5e-3 --set duration=0.003

# The same backend twice: the same numbers, but for the clock.
expect 0 "$heap" --out "$work/twice" --quiet --backends dvi,dvi --seeds 2 --no-refine
holds "$work/twice/compare.json" '"dvi-2"'
says 'agree about all'
[ "$(grep '"difference": ' "$work/twice/compare.json" | grep -vc ': -\{0,1\}0\.0,')" = 3 ] || fail 'the same backend differs from itself in more than its three times'

# Interrupted, then taken up again: finished runs are used.
"$compare" "$heap" --out "$work/stopped" --quiet --backends dvi,bullet --seeds 30 --threads 1 --set duration=0.02 >"$work/log" 2>&1 &
process=$!
while [ "$(ls "$work/stopped/jobs" 2>/dev/null | wc -l)" -lt 3 ] && kill -0 "$process" 2>/dev/null; do sleep 0.05; done
kill -INT "$process"
status=0
wait "$process" || status=$?
[ "$status" = 130 ] || fail "exit status $status after an interruption"
says '--resume'
[ ! -e "$work/stopped/compare.json" ] || fail 'an interrupted comparison claims to be complete'
before=$(ls "$work/stopped/jobs" | sort | head -n 1)
stamp=$(stat -c %Y.%i "$work/stopped/jobs/$before")
expect 0 "$heap" --out "$work/stopped" --backends dvi,bullet --seeds 30 --threads 2 --set duration=0.02 --resume
[ "$(stat -c %Y.%i "$work/stopped/jobs/$before")" = "$stamp" ] || fail 'a finished run was run again'
grep -qE '\([1-9][0-9]* reused' "$work/log" || fail 'no run was used again'

# Cost: points up to the cap.
expect 0 --cost --out "$work/cost" --grains 20,40 --cap 5 --backends dvi
holds "$work/cost/cost.json" '"wall_per_simulated_s"'
rm -rf -- "$work"
