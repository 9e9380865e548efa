#!/bin/sh
# Runs that are interrupted, killed or find damaged checkpoints end with the same bytes as one that was left alone.
#
#   resume_test.sh CASE REPOSE_RUN READ_FRAMES SCENE WORK_DIR      CASE: interrupt, kill, damage
set -eu
case=$1 run=$2 read_frames=$3 scene=$4 work=$5
# Waiting threads must not spin: the test machine may have fewer processors than threads.
export OMP_WAIT_POLICY=passive

rm -rf -- "$work"
mkdir -p -- "$work"

fail() {
  printf 'FAILED: %s\n' "$*" >&2
  exit 1
}
seconds() { date +%s.%N; }

# simulate DIR THREADS [OPTION...]
simulate() {
  dir=$1 threads=$2
  shift 2
  "$run" "$scene" --out "$dir" --threads "$threads" --checkpoint-interval 0.05 --quiet "$@" >>"$dir.log" 2>&1
}

# expect STATUS COMMAND...
expect() {
  wanted=$1
  shift
  status=0
  "$@" || status=$?
  [ "$status" = "$wanted" ] || fail "exit status $status instead of $wanted: $* ($(tail -n 3 -- "$dir.log" || true))"
}

# same DIR: its files are those of the reference run.
same() {
  for file in run.h5 run.xmf; do cmp -- "$work/reference/$file" "$1/$file" || fail "$1/$file differs"; done
  for frame in "$work"/reference/frames/*; do
    cmp -- "$frame" "$1/frames/${frame##*/}" || fail "$1: ${frame##*/} differs"
  done
  [ "$(ls "$work/reference/frames")" = "$(ls "$1/frames")" ] || fail "$1 has other frames"
  [ -f "$1/result.json" ] || fail "$1 has no result.json"
}

# start DIR THREADS [OPTION...]: in the background, as $process.
start() {
  dir=$1 threads=$2
  shift 2
  "$run" "$scene" --out "$dir" --threads "$threads" --checkpoint-interval 0.05 --quiet "$@" >>"$dir.log" 2>&1 &
  process=$!
}

# await FILE: until it is there or the process has ended.
await() {
  while [ ! -e "$1" ] && kill -0 "$process" 2>/dev/null; do sleep 0.02; done
}

begin=$(seconds)
dir=$work/reference
expect 0 simulate "$work/reference" 1
wall=$(echo "$begin $(seconds)" | awk '{print $2 - $1}')
printf 'reference run: %s s\n' "$wall"

case $case in
interrupt)
  for frame in 000000 000013; do
    dir=$work/interrupted-$frame
    start "$dir" 2
    await "$dir/frames/frame-$frame.h5"
    kill -INT "$process"
    expect 130 wait "$process"
    [ ! -e "$dir/result.json" ] || fail "an interrupted run claims to be complete"
    [ -e "$dir/run.h5" ] || fail "an interrupted run can be looked at"
    expect 0 simulate "$dir" 1 --resume
    same "$dir"
    expect 0 simulate "$dir" 2 --resume
    same "$dir"
  done
  ;;
kill)
  k=0
  while [ $k -lt 10 ]; do
    k=$((k + 1))
    dir=$work/killed-$k
    start "$dir" $((1 + k % 2))
    # Multiples of the golden ratio spread the moments over the whole run; the square favours its beginning.
    sleep "$(echo "$wall $k" | awk '{x = 0.618034 * $2; x -= int(x); print $1 * x * x}')"
    kill -KILL "$process" 2>/dev/null || true
    wait "$process" 2>/dev/null || true
    frames=0
    if [ -d "$dir/frames" ]; then frames=$("$read_frames" "$dir") || fail "a frame of $dir is damaged"; fi
    printf 'killed with %s frames\n' "$frames"
    expect 0 simulate "$dir" 1 --resume
    same "$dir"
  done
  # One run that is killed again and again.
  dir=$work/killed-often
  k=0
  while [ $k -lt 6 ]; do
    k=$((k + 1))
    start "$dir" 1 --resume
    sleep "$(echo "$wall" | awk '{print 0.4 * $1}')"
    kill -KILL "$process" 2>/dev/null || true
    wait "$process" 2>/dev/null || true
  done
  expect 0 simulate "$dir" 2 --resume
  same "$dir"
  ;;
damage)
  dir=$work/damaged
  start "$dir" 1
  await "$dir/frames/frame-000015.h5"
  kill -INT "$process"
  expect 130 wait "$process"
  newest=$(ls "$dir/checkpoints" | tail -n 1)
  older=$(ls "$dir/checkpoints" | head -n 1)
  [ "$newest" != "$older" ] || fail "two checkpoints are kept"
  cp -R -- "$dir" "$dir-both"
  truncate -s 3000 -- "$dir/checkpoints/$newest"
  expect 0 simulate "$dir" 1 --resume
  grep -q "$newest.*truncated or damaged" "$dir.log" || fail "the damaged checkpoint is not named"
  same "$dir"

  dir=$dir-both
  truncate -s 3000 -- "$dir/checkpoints/$newest" "$dir/checkpoints/$older"
  expect 2 simulate "$dir" 1 --resume
  grep -q 'no checkpoint is intact' "$dir.log" || fail "no message about the checkpoints"

  dir=$work/interrupted-other
  start "$dir" 1
  await "$dir/frames/frame-000003.h5"
  kill -INT "$process"
  expect 130 wait "$process"
  expect 2 simulate "$dir" 1 --resume --seed 2
  expect 2 simulate "$dir" 1 --resume --set gravity=[0,0,-1]
  expect 0 simulate "$dir" 1 --resume
  same "$dir"
  ;;
*) fail "unknown case $case" ;;
esac
rm -rf -- "$work"
