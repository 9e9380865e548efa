#!/bin/sh
# Diagnoses every bundle of a folder and tells what was said beside what is true.
#
#   make_recordings.py FOLDER SEED; diagnose_all.sh FOLDER
#
# REPOSE: the command (default: the launcher at the root).
set -eu
folder=$1
repose=${REPOSE:-$(dirname "$0")/../../../repose}
for bundle in "$folder"/*/; do
  name=$(basename "$bundle")
  "$repose" diagnose "$bundle" --out "$folder/.out/$name" --quiet >"$folder/$name.log" 2>&1 || true
done
python3 - "$folder" <<'PYTHON'
import json, pathlib, sys
folder = pathlib.Path(sys.argv[1])
right = total = 0
for bundle in sorted(p for p in folder.iterdir() if (p / "truth").exists()):
    truth, result = (bundle / "truth").read_text().strip(), folder / ".out" / bundle.name / "diagnosis.json"
    d = json.loads(result.read_text()) if result.exists() else {"verdict": "failed", "missing": [], "indistinguishable": [], "wall_s": 0}
    said = "+".join(sorted(m["effect"] for m in d["missing"])) or d["verdict"]
    total += 1
    right += said in truth.split("|")
    rivals = " of " + ", ".join(d["indistinguishable"][0]) if d["indistinguishable"] else ""
    print(f"{bundle.name:18} {truth:32} {d['verdict']:12} {said:34} {d['wall_s']:5.0f} s{rivals}")
print(f"{right} of {total} named as they are")
PYTHON
