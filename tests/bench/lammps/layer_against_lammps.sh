#!/bin/sh
# The same bed, roller and travel in repose and in LAMMPS (Debian: lammps), one thread each: time to the same surface statistics.
# Wall-clock time of the time loops alone: let nothing else run beside it.
#
#   layer_against_lammps.sh BUILD_DIR OUT_DIR SCENE.yaml YOUNG_PA [SEED [WIDTH]]
#
# YOUNG_PA softens the grains of LAMMPS until they overlap by about 1 % of a diameter; what they did is told. WIDTH: so many times
# as wide and with so many times the grains as layer-quick.yaml, which SCENE must then be (4: 20,000 grains).
set -eu
build=$1 out=$2 scene=$3 young=$4 seed=${5:-1} width=${6:-1}
export OMP_NUM_THREADS=1 OMP_WAIT_POLICY=passive
mkdir -p -- "$out"
wide() { # COMMAND... with the scene made wider
  if [ "$width" = 1 ]; then
    "$@"
    return
  fi
  y=$(awk "BEGIN { print 0.35 * $width }") tool=$(awk "BEGIN { print 0.7 * $width + 0.4 }")
  set -- "$@" --set grains.bed.count=$((4750 * width)) --set grains.pile.count=$((250 * width)) \
    --set "grains.bed.fill.box={lower: [-0.7 mm, -$y mm, 0], upper: [2.3 mm, $y mm, 1.3 mm]}" \
    --set "grains.pile.fill.box={lower: [-0.5 mm, -$y mm, 1.4 mm], upper: [-0.1 mm, $y mm, 1.6 mm]}" \
    --set "tools.floor.size=[4.8 mm, $tool mm, 0.2 mm]" --set "tools.roller.width=$tool mm" \
    --set "layer.region={lower: [0.1 mm, -$y mm], upper: [2.1 mm, $y mm]}" --set "layer.sides.y=[-$y mm, $y mm]"
  for plate in near_end far_end catch_near catch_far; do set -- "$@" --set "tools.$plate.size=[0.1 mm, $tool mm, 0.4 mm]"; done
  "$@"
}
handed() { wide "$build/tests/bench/lammps/layer_for_lammps" "$scene" --seed "$seed" --threads 1 --beds "$out/beds" --out "$out/lammps" "$@"; }
lammps() { (cd -- "$out/lammps" && lmp -in "$1.in" -log "$1.log" >/dev/null) || { tail -n 20 -- "$out/lammps/$1.log" >&2; exit 1; }; }

wide "$build/scenarios/repose-layer" "$scene" --seed "$seed" --threads 1 --quiet --beds "$out/beds" --out "$out/repose" >"$out/repose.log"
handed --young "$young"
lammps settle
lammps spread
echo 'repose, lengths in um'
grep -E '^(surface|  before|  after|layer|wall)' "$out/repose.log"
echo 'LAMMPS'
handed --measure
grep 'Loop time' "$out/lammps/settle.log" | sed 's/^/the softened bed at rest: /'
grep 'Loop time' "$out/lammps/spread.log" | sed 's/^/the layer: /'
