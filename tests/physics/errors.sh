#!/bin/sh
# Runs the physics cases on every backend and writes what they print as one table per idea: errors.md.
#
#   errors.sh FOLDER TABLE IDEA[=LEFT_OUT]...
#
# FOLDER holds the executables IDEA_test; LEFT_OUT is a list of patterns of cases, separated by colons, that are not run. The
# target physics_errors calls it. The rows of an idea on a backend are kept in FOLDER/errors and used again until its executable is
# built anew, so that a run that was stopped goes on. The table is written only if every case holds; exit status 1 otherwise.
set -eu
folder=$1
table=$2
shift 2
kept=$folder/errors
mkdir -p -- "$kept"
rows=$(mktemp)
trap 'rm -f -- "$rows" "$rows.out"' EXIT

backends=$("$folder/worlds_test" --gtest_list_tests | sed -n 's|^ .*/\([a-z]*\) .*|\1|p' | awk '!seen[$0]++')
first=$(printf '%s\n' "$backends" | head -n 1)
others=$(printf '%s\n' "$backends" | tail -n +2 | sed 's|^|*/|' | paste -sd : -)

failed=0
for argument; do
  idea=${argument%%=*}
  left_out=''
  case $argument in *=*) left_out=:${argument#*=} ;; esac
  for backend in $backends; do
    # Cases of no backend are told beside the first one.
    if [ "$backend" = "$first" ]; then filter="-$others$left_out"; else filter="*/$backend-$left_out"; fi
    own=$kept/$idea.$backend
    if [ -z "$(find "$own" -newer "$folder/${idea}_test" 2>/dev/null)" ] || [ "$(head -n 1 "$own")" != "$filter" ]; then
      echo "$idea, $backend"
      if OMP_WAIT_POLICY=passive "$folder/${idea}_test" --gtest_filter="$filter" >"$rows.out" 2>&1; then
        { printf '%s\n' "$filter"; sed -n "s/^| \(.*\) |\$/$idea | $backend | \1/p" "$rows.out"; } >"$own.new"
        mv -- "$own.new" "$own"
      else
        grep -A 3 ': Failure' "$rows.out" || tail -n 5 "$rows.out"
        rm -f -- "$own"
        failed=1
        continue
      fi
    fi
    tail -n +2 "$own" >>"$rows"
  done
done
if [ "$failed" != 0 ]; then
  echo "some cases do not hold: $table is left as it is" >&2
  exit 1
fi

# A line of rows is: idea | backend | case | closed form | measured | error | tolerance. A case may hold bars, but none between blanks.
awk -F ' [|] ' -v backends="$(printf '%s' "$backends" | tr '\n' ' ')" '
  BEGIN { engines = split(backends, engine, " ") }
  {
    what = $3
    for (i = 4; i <= NF - 4; ++i) what = what " | " $i
    n = ++times[$1, $2, what]  # a case may be told several times
    key = $1 SUBSEP what SUBSEP n
    if (!(key in closed)) {
      if (!($1 in cases)) idea[++ideas] = $1
      order[$1, ++cases[$1]] = key
      name[key] = what
      closed[key] = $(NF - 3)
      tolerance[key] = $NF
    }
    # DART is held to 1e-8, or to a wider tolerance of the case; what an engine is allowed beyond that is a stated limit.
    told = $(NF - 2)
    if ($(NF - 1) != "-") told = told ", " $(NF - 1)
    if ($NF != "-" && $NF + 0 > 1.001 * tolerance[key] && $NF + 0 > 1.001e-8) told = told " (limit " $NF ")"
    cell[key, $2] = told
  }
  END {
    print "# Errors of every case, by backend\n"
    print "Written by `ninja physics_errors`; what it says and which cases are run: [README.md](README.md). A cell holds the measured"
    print "number and its error, relative where the answer is not zero and against the discrete answer where the integrator has one."
    print "DART is held to 1e-8 where the tolerance is smaller; a limit is stated with its reason in [limits](limits). Cases"
    print "without a closed form are figures. `–`: not run. Digits at the rounding level depend on the processor."
    for (i = 1; i <= ideas; ++i) {
      header = "| case | closed form |"
      rule = "|---|---|"
      for (e = 1; e <= engines; ++e) {
        header = header " " engine[e] " |"
        rule = rule "---|"
      }
      printf "\n## %s\n\n%s tolerance |\n%s---|\n", idea[i], header, rule
      for (c = 1; c <= cases[idea[i]]; ++c) {
        key = order[idea[i], c]
        what = name[key]
        gsub(/[|]/, "\\|", what)
        row = "| " what " | " (closed[key] == "-" ? "–" : closed[key]) " |"
        for (e = 1; e <= engines; ++e) row = row " " ((key, engine[e]) in cell ? cell[key, engine[e]] : "–") " |"
        print row " " (tolerance[key] == "-" ? "–" : tolerance[key]) " |"
      }
    }
  }' "$rows" >"$rows.out"
mv -- "$rows.out" "$table"
