#!/bin/sh
# Opens the pages that Repose writes in headless Chromium, without network: no message on the console, every chart drawn,
# the film's first frame shown. A damaged page must be found out, so that a pass means something.
#
#   check_pages.sh SAMPLE_PAGES     the program that writes report.html and film.html into a folder
#
# Exit status 77 (skipped) without Chromium, unless CI is set.
set -eu

browser=
for name in chromium chromium-browser google-chrome; do
  if command -v "$name" >/dev/null; then
    browser=$name
    break
  fi
done
if [ -z "$browser" ]; then
  echo "no Chromium on the PATH: install the package chromium" >&2
  if [ -n "${CI:-}" ]; then exit 1; else exit 77; fi
fi

work=$(mktemp -d)
trap 'rm -rf -- "$work"' EXIT
"$1" "$work"

# open_page FILE [OPTION...]: the page's own elements after its scripts have run to $work/dom, the browser's log to $work/log.
open_page() {
  page=$1
  shift
  rm -rf -- "$work/profile"
  timeout 120 "$browser" --headless --no-sandbox --disable-gpu --disable-background-networking --disable-component-update \
    --disable-sync --no-first-run --user-data-dir="$work/profile" --host-resolver-rules='MAP * ~NOTFOUND' \
    --proxy-server=127.0.0.1:9 --enable-logging=stderr --virtual-time-budget=60000 "$@" \
    --dump-dom "file://$work/$page" >"$work/dom" 2>"$work/log"
}

# opening_tag: the <html ...> tag, where the scripts leave their verdict.
opening_tag() { grep -o '<html[^>]*>' "$work/dom" | head -n 1; }

failures=0
fail() {
  echo "FAILED: $*" >&2
  failures=$((failures + 1))
}

# sound FILE EXPECTED...: true if the page says everything in EXPECTED, no error, and nothing on the console.
sound() {
  page=$1
  shift
  tag=$(opening_tag)
  for expected; do
    case $tag in *"$expected"*) ;; *) return 1 ;; esac
  done
  case $tag in *data-error*) return 1 ;; esac
  ! grep -q CONSOLE "$work/log"
}

for scheme in 0 1; do
  open_page report.html --blink-settings=preferredColorScheme=$scheme
  sound report.html 'data-charts-expected="3"' 'data-charts-drawn="3"' ||
    fail "report.html (colour scheme $scheme): $(opening_tag) $(grep CONSOLE "$work/log" || true)"
done
# Two residual charts in front, two behind, the force against its variable, the gains; nothing missing: residuals alone. Of a heap: profile and discharge.
for case in missing:6 ambiguous:6 unknown:6 measurement:6 numerics:6 none:4 heap:2; do
  page=diagnosis-${case%:*}.html
  open_page "$page"
  sound "$page" "data-charts-expected=\"${case#*:}\"" "data-charts-drawn=\"${case#*:}\"" ||
    fail "$page: $(opening_tag) $(grep CONSOLE "$work/log" || true)"
done
open_page film.html
sound film.html 'data-frames="3"' 'data-frame-shown="0"' ||
  fail "film.html: $(opening_tag) $(grep CONSOLE "$work/log" || true)"

sed 's/"equal":true/"equal":true,,/' "$work/report.html" >"$work/damaged.html"
open_page damaged.html
if sound damaged.html 'data-charts-expected="3"' 'data-charts-drawn="3"'; then fail "a chart with broken data went unnoticed"; fi
sed 's|</main>|<img src="https://example.org/a.png" alt="">&|' "$work/report.html" >"$work/damaged.html"
open_page damaged.html
if sound damaged.html 'data-charts-expected="3"'; then fail "a picture from elsewhere went unnoticed"; fi

if [ "$failures" != 0 ]; then exit 1; fi
echo "report, diagnoses and film open without network, without errors, every chart drawn"
