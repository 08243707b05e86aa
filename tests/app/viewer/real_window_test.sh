#!/usr/bin/env bash
# A real window under Xvfb, a real pointer and real keys: what they do to the scene has to be what the same
# drag does headless. real_window_test.sh IVORY SCENE FOLDER; exit 77 where a tool is missing.
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
cp "$scene" window.ivory.json
cp "$scene" memory.ivory.json

# Headless: where the handle is, and what the drag makes of the scene.
printf '%s\n' '{"select": "segment 1"}' '{"state": "state.json"}' \
    '{"drag": {"element": "segment 1", "handle": "b", "by": [60, -40]}}' '{"key": "ctrl+s"}' >memory.script
"$ivory" memory.ivory.json --headless --size 1280x720 --script memory.script
read -r x y row_x row_y < <(python3 - <<'PYTHON'
import json
state = json.load(open("state.json"))
x, y = state["handles"]["segment 1"]["b"]
rx, ry, rw, rh = state["widgets"]["row.segment 1"]
print(round(x), round(y), rx + rw // 2, ry + rh // 2)
PYTHON
)

pids=()
cleanup() { for pid in "${pids[@]}"; do kill "$pid" 2>/dev/null || true; done; }
trap cleanup EXIT
Xvfb -displayfd 3 -screen 0 1400x900x24 +extension GLX 3>display >/dev/null 2>&1 &
pids+=($!)
for _ in $(seq 100); do [[ -s display ]] && break; sleep 0.1; done
DISPLAY=:$(cat display)
export DISPLAY

"$ivory" window.ivory.json --size 1280x720 --no-settings &
viewer=$!
pids+=("$viewer")
window=$(timeout 30 xdotool search --sync --onlyvisible --name '^Ivory' | head -n 1)
at() { xdotool mousemove --window "$window" "$1" "$2" sleep 0.15; }
sleep 2
at "$row_x" "$row_y"
xdotool click 1 sleep 0.3
at "$x" "$y"
xdotool mousedown 1 sleep 0.15
for step in 1 2 3 4; do at $((x + 15 * step)) $((y - 10 * step)); done
xdotool mouseup 1 sleep 0.3 key ctrl+s sleep 0.5 key ctrl+q
for _ in $(seq 100); do kill -0 "$viewer" 2>/dev/null || break; sleep 0.1; done
if kill -0 "$viewer" 2>/dev/null; then
    echo "the window did not close"
    exit 1
fi
wait "$viewer"

# A file that is not there: the window opens all the same, and the terminal says it too.
"$ivory" missing.ivory.json --no-settings 2>missing.err &
viewer=$!
pids+=("$viewer")
for _ in $(seq 100); do
    if [[ -s missing.err ]]; then break; fi
    sleep 0.1
done
kill "$viewer"
wait "$viewer" || true
if [[ $(wc -l <missing.err) != 1 ]] || ! grep -q 'missing.ivory.json: cannot be read' missing.err; then
    echo "the terminal was told: $(cat missing.err)"
    exit 1
fi

python3 - "$scene" <<'PYTHON'
import json, sys
before, memory, window = (json.load(open(f)) for f in (sys.argv[1], "memory.ivory.json", "window.ivory.json"))
[place] = [i for i, e in enumerate(before["elements"]) if e["shape"] == "segment"][:1]
a, b, c = (s["elements"][place]["b"] for s in (before, memory, window))
assert a != b, "the drag in memory moved nothing"
assert max(abs(p - q) for p, q in zip(b, c)) < 1e-9, f"window {c}, memory {b}"
PYTHON
echo "the window and the memory agree"
