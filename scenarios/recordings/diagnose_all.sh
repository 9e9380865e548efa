#!/bin/sh
# Diagnoses every bundle of real recordings. Results go to OUT/<bundle>; those that are complete are kept.
#
#   scenarios/recordings/diagnose_all.sh RECORDINGS [OUT] [options of repose diagnose]
set -eu
here=$(dirname -- "$(readlink -f -- "$0")")
recordings=${1:?give the folder that holds ball_drops, phone_fall and cube_tosses}
shift
out=out/recordings
case ${1:-} in '' | -*) ;; *) out=$1; shift ;; esac

for bundle in ball_drops/recording phone_fall/recording cube_tosses/recording cube_tosses/recording_frictionless \
  cube_tosses/recording_no_restitution; do
  set_of=${bundle%/*}
  to=$out/$(printf %s "$bundle" | tr / -)
  [ ! -e "$to/diagnosis.json" ] || continue
  "$here/../../repose" diagnose "$here/$bundle.yaml" --root "$recordings/$set_of" --out "$to" "$@"
done
