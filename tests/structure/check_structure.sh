#!/bin/sh
# Holds the architecture by what files include. Prints every breach as "file:line: rule"; exit status 1 if there is one.
#
#   check_structure.sh ROOT
#
#   core      <- backends, analysis, scenarios: dependencies run one way, and analysis never sees a backend
#   dvi       only the world's files (world_dvi*, contact_finder, units) see a model; collision knows shapes alone, the cone solver its plain problem alone
#   bullet    takes geometry, units and the plain problem from dvi, never its solver or its world; so does dart
#   packages  heavy headers stay inside .cpp files
#   files     at most 500 lines; nothing is left to be done later
set -eu
cd -- "$1"
breaches=$(mktemp)
trap 'rm -f -- "$breaches"' EXIT

# forbid RULE PATTERN FILE...: no line of the files may match the extended regular expression.
forbid() {
  rule=$1
  pattern=$2
  shift 2
  if [ $# = 0 ]; then return; fi
  grep -nHE -- "$pattern" "$@" | sed -E "s|^([^:]*:[0-9]+):(.*)|\1: $rule:\2|" >>"$breaches" || true
}

# sources FOLDER NAME_PATTERN: files of the folder tree whose name matches.
sources() { if [ -d "$1" ]; then find "$1" -type f -name "$2" | sort; fi; }
code() { sources "$1" '*.[ch]pp'; }
include() { printf '^[[:space:]]*#[[:space:]]*include[[:space:]]*["<](%s)' "$1"; }

# shellcheck disable=SC2046
{
  forbid 'core includes only core' "$(include 'backends/|analysis/|scenarios/|tests/')" $(code core)
  forbid 'backends include only core' "$(include 'analysis/|scenarios/|tests/')" $(code backends)
  forbid 'analysis includes only core' "$(include 'backends/|scenarios/|tests/')" $(code analysis)
  forbid 'scenarios never include tests' "$(include 'tests/')" $(code scenarios)
  forbid 'a scenario knows backends by their table' "$(include 'backends/[a-z]+/')" $(code scenarios)

  # Inside dvi every file belongs to the world (free), to collision (shapes), or to the cone solver (plain data).
  dvi=backends/dvi
  world='(world_dvi|contact_finder|units)[a-z_]*\.[ch]pp$'
  collision='(narrow|broad|collide|support|gjk|oracle)[a-z_]*\.[ch]pp$'
  beside_world=$(code $dvi | grep -vE "/$world" || true)
  solver=$(printf '%s\n' "$beside_world" | grep -vE "/$collision" || true)
  collision_files=$(printf '%s\n' "$beside_world" | grep -E "/$collision" || true)
  forbid 'only world_dvi sees a scene or a model' \
    "$(include 'core/(scene|model|effect|recording|run|population|fill|tool|grain_shape|plausibility)')" $beside_world
  forbid 'collision and cone solver do not know the world' "$(include "$dvi/(world_dvi|contact_finder|units)")" $beside_world
  forbid 'collision and cone solver do not know each other' "$(include "$dvi/(cone|solver|apgd|gauss)")" $collision_files
  forbid 'collision and cone solver do not know each other' "$(include "$dvi/(narrow|broad|collide)")" $solver
  forbid 'the cone solver knows no shape, motion or material' "$(include 'core/(shape|motion|material|mass_properties)')" $solver

  forbid 'bullet shares no solver and no world with dvi' \
    "$(include "$dvi/(world_dvi|contact_finder|gauss|projected|packed|batch|colouring|momentum|residual)")" $(code backends/bullet)
  forbid 'dart shares no solver and no world with dvi' \
    "$(include "$dvi/(world_dvi|gauss|projected|packed|batch|colouring|momentum|residual)")" $(code backends/dart)

  libraries=$(for folder in core backends analysis; do sources $folder '*.hpp'; done)
  headers="$libraries $(sources scenarios '*.hpp')"
  forbid 'this package is included by .cpp files only' \
    "$(include 'embree|hdf5|H5|yaml-cpp|png\.h|CLI/|benchmark|openvdb|bullet/|bt[A-Z]|Bullet|LinearMath|dart/')" $headers
  forbid 'library headers need no JSON package' "$(include 'nlohmann/json\.')" $libraries

  all=$(for folder in core backends analysis scenarios tests; do code $folder; done)
  forbid 'nothing is left to be done later' '\b(TODO|FIXME|XXX|HACK)\b' $all
  for file in $all; do
    lines=$(wc -l <"$file")
    if [ "$lines" -gt 500 ]; then echo "$file:501: at most 500 lines: it has $lines" >>"$breaches"; fi
  done
}

if [ -s "$breaches" ]; then
  cat -- "$breaches"
  exit 1
fi
