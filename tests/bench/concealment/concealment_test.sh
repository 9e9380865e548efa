#!/usr/bin/env bash
# The benchmark on a few cases. Usage: concealment_test.sh BIN_DIR
#
# Judges the programs, not the diagnosis: that cases are the same for the same seed, that every case gets a verdict without an error, and a score,
# and that the seal holds.
set -eu
bin=$(cd "$1" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

fail() { echo "FAILED: $1"; exit 1; }
# refused WHAT COMMAND...: the command must end with status 2 and name what is wrong.
refused() {
  what=$1
  shift
  status=0
  "$@" >output 2>&1 || status=$?
  [ $status -eq 2 ] || fail "status $status instead of 2: $*"
  grep -qF -- "$what" output || { cat output; fail "the message does not say \"$what\""; }
}

wanted="nominal=1 C0=1"
"$bin/concealment_generate" --out cases --cases $wanted --seed 5
"$bin/concealment_generate" --out again --cases $wanted --seed 5
diff -r cases again || fail "the same seed gives other cases"
refused "holds cases already" "$bin/concealment_generate" --out again --cases $wanted
refused "no such level" "$bin/concealment_generate" --out other --cases C9=1
! grep -rqE 'C0|outside' cases/cases cases/manifest.json || fail "a label is visible"

refused "no verdict yet" "$bin/concealment_score" cases
"$bin/concealment_diagnose" cases --jobs 1
"$bin/concealment_diagnose" cases --jobs 1 | grep -q "2 of 2" || fail "verdicts are not kept"
"$bin/concealment_score" cases >page.md
"$bin/concealment_diagnose" cases --oracle
"$bin/concealment_diagnose" cases --suggested
"$bin/concealment_score" cases --page page.md
grep -q "^| case-002 |" page.md || fail "a case is not scored"
! grep -qE "^\\| case-00[12] .*\\| failed \\|" page.md || fail "a diagnosis ended with an error"

refused "opened already" "$bin/concealment_diagnose" cases
cp -r cases late
echo >>late/verdicts/jobs/case-001.json
refused "younger than the opening" "$bin/concealment_score" late
sed -i 's/"nominal"/"C0"/' cases/sealed/truth.json
refused "is not the truth whose SHA-256" "$bin/concealment_score" cases
echo "2 cases, every seal held"
