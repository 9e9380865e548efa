#!/bin/sh
# What the README tells a user to type works.
#
#   readme_test.sh README BUILT_REPOSE SOURCE_TREE
#
# Of each block ```sh, every `./repose <command>` must be a command, and every file of the tree that it names must be there.
# A block after the line <!-- quick --> is run as it stands, in a scratch folder that looks like a clone; it must exit 0.
set -eu
readme=$1
repose=$2
source=$3
scratch=$(mktemp -d)
trap 'rm -rf -- "$scratch"' EXIT
mkdir "$scratch/clone"
ln -s "$repose" "$scratch/clone/repose"
ln -s "$source/scenarios" "$scratch/clone/scenarios"
ln -s "$source/tests" "$scratch/clone/tests"

# One file per block: NN.quick or NN.named.
awk -v out="$scratch" '
  /^```sh$/ { inside = 1; ++n; file = sprintf("%s/%02d.%s", out, n, quick ? "quick" : "named"); printf "" > file; next }
  /^```/    { if (inside) close(file); inside = 0; quick = 0; next }
  inside    { print > file; next }
  /^<!-- quick -->$/ { quick = 1; next }
  NF        { quick = 0 }
' "$readme"

failures=0
fail() {
  echo "README: $1"
  failures=$((failures + 1))
}

cd -- "$scratch/clone"
blocks=0
for block in "$scratch"/*.quick "$scratch"/*.named; do
  if [ ! -f "$block" ]; then continue; fi
  blocks=$((blocks + 1))
  sh -n "$block" || fail "not a shell command: $(cat "$block")"
  for command in $(sed -nE 's|^(.*[ ;&])?\./repose ([a-z]+).*|\2|p' "$block" | sort -u); do
    if [ "$command" = test ]; then continue; fi  # the launcher's own
    ./repose "$command" --help >/dev/null 2>&1 || fail "no such command: repose $command"
  done
  for file in $(grep -oE '(^|[ =])(scenarios|tests|core)/[A-Za-z0-9_./-]+' "$block" | tr -d ' ='); do
    [ -e "$source/$file" ] || fail "no such file: $file"
  done
done
[ "$blocks" -gt 0 ] || fail 'no block of commands found'

for block in "$scratch"/*.quick; do
  if [ ! -f "$block" ]; then continue; fi
  echo "running:"
  sed 's/^/  /' "$block"
  sh -eu "$block" >"$scratch/log" 2>&1 || {
    cat "$scratch/log"
    fail "this block failed"
  }
done
[ "$failures" = 0 ]
