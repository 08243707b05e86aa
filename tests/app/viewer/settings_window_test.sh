#!/usr/bin/env bash
# What a user sets in a real window under Xvfb is there the next day; neither --no-settings nor --headless
# touches it. settings_window_test.sh IVORY SCENE FOLDER; exit 77 where a tool is missing.
set -euo pipefail
ivory=$1 scene=$2 folder=$3
for tool in Xvfb xdotool; do
    if ! command -v "$tool" >/dev/null; then
        echo "SKIPPED: no $tool on this machine"
        exit 77
    fi
done
rm -rf "$folder"
mkdir -p "$folder"
cd "$folder"
cp "$scene" scene.ivory.json
export XDG_CONFIG_HOME=$PWD/config
settings=config/ivory/settings.json

pids=()
cleanup() { for pid in "${pids[@]}"; do kill "$pid" 2>/dev/null || true; done; }
trap cleanup EXIT
Xvfb -displayfd 3 -screen 0 1400x900x24 +extension GLX 3>display >/dev/null 2>&1 &
pids+=($!)
for _ in $(seq 100); do [[ -s display ]] && break; sleep 0.1; done
DISPLAY=:$(cat display)
export DISPLAY

fail() { echo "$1"; cat "$settings" message 2>/dev/null || true; exit 1; }
# open WORDS...: sets `viewer` and `window`.
open() {
    "$ivory" scene.ivory.json "$@" 2>message &
    viewer=$!
    pids+=("$viewer")
    window=$(timeout 30 xdotool search --sync --onlyvisible --name '^Ivory - ' | head -n 1)
    sleep 1.5
}
quit() {
    xdotool mousemove --window "$window" 600 400 sleep 0.2 key ctrl+q
    for _ in $(seq 100); do kill -0 "$viewer" 2>/dev/null || break; sleep 0.1; done
    if kill -0 "$viewer" 2>/dev/null; then fail "the window did not close"; fi
    wait "$viewer"
}
has() { grep -q "\"$1\": $2" "$settings" || fail "no \"$1\": $2 in the settings"; }

open
quit
[[ ! -e $settings ]] || fail "settings were written that nobody set"

open
xdotool key s sleep 0.3 windowsize "$window" 900 640 sleep 1.5
has skeleton false  # written while the window is open
quit
has window_width 900
has window_height 640

open
geometry=$(xdotool getwindowgeometry "$window")
[[ $geometry == *900x640* ]] || fail "the window was opened anew as $geometry"
xdotool key s sleep 0.3
quit
has skeleton true

# Samples, by a click where a viewer in memory has that widget.
echo '{"state": "state.json"}' >steps.script
"$ivory" scene.ivory.json --headless --size 1280x860 --script steps.script
read -r x y < <(python3 -c '
import json
left, top, width, height = json.load(open("state.json"))["widgets"]["view.samples.4"]
print(left + width // 2, top + height // 2)')
open --size 1280x860
xdotool mousemove --window "$window" "$x" "$y" sleep 0.2 click 1 sleep 0.3
quit
has samples 4
open
quit
has samples 4  # or the viewer had begun with another number, and that were kept

cp "$settings" before
open --no-settings
geometry=$(xdotool getwindowgeometry "$window")
[[ $geometry == *1280x720* ]] || fail "--no-settings opened $geometry"
xdotool key s sleep 0.3
quit
printf '%s\n' '{"key": "s"}' '{"theme": "light"}' >steps.script
"$ivory" scene.ivory.json --headless --script steps.script
cmp before "$settings"

echo '{"theme": ' >"$settings"
open
quit
grep -q "set aside as settings.json.broken" message || fail "nothing was said of a broken file"
[[ -e $settings.broken && ! -e $settings ]] || fail "a broken file was not set aside"
echo "settings last"
