#!/bin/sh
# The structure check finds each kind of breach, and nothing in a tree without any.
#
#   check_structure_test.sh CHECK_STRUCTURE
set -eu
check=$1
tree=$(mktemp -d)
trap 'rm -rf -- "$tree"' EXIT
mkdir -p "$tree/core" "$tree/backends/dvi" "$tree/backends/bullet" "$tree/backends/dart" "$tree/analysis" "$tree/scenarios" "$tree/tests"

write() { printf '%s\n' "$2" >"$tree/$1"; }

write backends/bullet/world_bullet.cpp '#include <BulletDynamics/Dynamics/btRigidBody.h>'
write core/scene.hpp '#include "core/math.hpp"'
write core/scene.cpp '#include <yaml-cpp/yaml.h>'
write backends/dvi/world_dvi.cpp '#include "core/model.hpp"'
write backends/dvi/narrow_phase.hpp '#include "core/shape.hpp"'
write backends/dvi/cone_solver.cpp '#include "core/world.hpp"'
write analysis/heap.cpp '#include "core/recording.hpp"'
write scenarios/aor.cpp '#include "backends/backends.hpp"'
if ! out=$(sh "$check" "$tree"); then
  echo "a clean tree was refused: $out"
  exit 1
fi

# breach FILE TEXT: with this file the check must fail and name it.
breach() {
  write "$1" "$2"
  if out=$(sh "$check" "$tree"); then
    echo "not found: $1 with $2"
    exit 1
  fi
  case $out in
    "$1:"*) ;;
    *)
      echo "$1 is not what was named: $out"
      exit 1
      ;;
  esac
  rm -- "$tree/$1"
}

breach core/bad.cpp '#include "backends/backends.hpp"'
breach core/bad.cpp '#include "analysis/heap.hpp"'
breach core/bad.hpp '#include "scenarios/common.hpp"'
breach backends/bad.cpp '#  include "analysis/heap.hpp"'
breach analysis/bad.cpp '#include "backends/backends.hpp"'
breach scenarios/bad.cpp '#include "backends/dvi/world_dvi.hpp"'
breach backends/dvi/cone_bad.cpp '#include "core/model.hpp"'
breach backends/dvi/cone_bad.cpp '#include "core/shape.hpp"'
breach backends/dvi/cone_bad.cpp '#include "backends/dvi/narrow_phase.hpp"'
breach backends/dvi/cone_bad.cpp '#include "backends/dvi/world_dvi.hpp"'
breach backends/dvi/narrow_bad.cpp '#include "core/scene.hpp"'
breach backends/dvi/narrow_bad.cpp '#include "backends/dvi/cone_problem.hpp"'
breach backends/bullet/bad.cpp '#include "backends/dvi/world_dvi.hpp"'
breach backends/bullet/bad.cpp '#include "backends/dvi/gauss_seidel.hpp"'
breach backends/dart/bad.cpp '#include "backends/dvi/gauss_seidel.hpp"'
breach backends/dart/bad.hpp '#include <dart/dynamics/Skeleton.hpp>'
breach backends/bullet/bad.hpp '#include <LinearMath/btTransform.h>'
breach core/bad.hpp '#include <hdf5.h>'
breach analysis/bad.hpp '#include <embree3/rtcore.h>'
breach core/bad.hpp '#include <nlohmann/json.hpp>'
breach tests/bad.cpp "// $(printf 'TO%s' DO): later"
breach core/bad.cpp "$(yes '' | head -n 501 | sed 's/^/\/\//')"
echo 'every kind of breach is found'
