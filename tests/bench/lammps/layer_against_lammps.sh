#!/bin/sh
# The same bed, roller and travel in repose and in LAMMPS (Debian: lammps), one thread each: time to the same surface statistics.
# Wall-clock time of the time loops alone: let nothing else run beside it.
#
#   layer_against_lammps.sh BUILD_DIR OUT_DIR SCENE.yaml YOUNG_PA [SEED]
#
# YOUNG_PA softens the grains of LAMMPS until they overlap by about 1 % of a diameter; what they did is told.
set -eu
build=$1 out=$2 scene=$3 young=$4 seed=${5:-1}
export OMP_NUM_THREADS=1 OMP_WAIT_POLICY=passive
mkdir -p -- "$out"
handed() { "$build/tests/bench/lammps/layer_for_lammps" "$scene" --seed "$seed" --threads 1 --beds "$out/beds" --out "$out/lammps" "$@"; }
lammps() { (cd -- "$out/lammps" && lmp -in "$1.in" -log "$1.log" >/dev/null) || { tail -n 20 -- "$out/lammps/$1.log" >&2; exit 1; }; }

"$build/scenarios/repose-layer" "$scene" --seed "$seed" --threads 1 --quiet --beds "$out/beds" --out "$out/repose" >"$out/repose.log"
handed --young "$young"
lammps settle
lammps spread
echo 'repose, lengths in um'
grep -E '^(surface|  before|  after|layer|wall)' "$out/repose.log"
echo 'LAMMPS'
handed --measure
grep 'Loop time' "$out/lammps/settle.log" | sed 's/^/the softened bed at rest: /'
grep 'Loop time' "$out/lammps/spread.log" | sed 's/^/the layer: /'
