#!/usr/bin/env bash
# One viewer that opens, edits, undoes and resizes so many times: in the end it shows the picture of the
# beginning, and under the address sanitizer it has leaked nothing.
# rounds_test.sh IVORY SCENE FOLDER ROUNDS; exit 77 where there is no OpenGL in memory.
set -euo pipefail
ivory=$1 scene=$2 folder=$3 rounds=$4
rm -rf "$folder"
mkdir -p "$folder"
cd "$folder"
cp "$scene" scene.ivory.json
cp "$scene" again.ivory.json

{
    echo '{"wait": "final"}'
    echo '{"screenshot": "first.png", "viewport": true}'
    for round in $(seq "$rounds"); do
        echo "# round $round"
        echo '{"drop": "again.ivory.json"}'
        echo '{"drag": {"element": "segment 1", "handle": "middle", "by": [20, -15]}}'
        echo '{"widget": "threshold", "set": 0.4}'
        echo '{"widget": "add.circle"}'
        echo '{"widget": "element.width", "set": 0.3}'
        echo '{"resize": "640x380"}'
        if ((round % 10 == 1)); then
            echo '{"wait": "final"}'
            echo "{\"screenshot\": \"edited-$round.png\", \"viewport\": true}"
        fi
        for _ in 1 2 3 4; do echo '{"key": "ctrl+z"}'; done
        echo '{"key": "ctrl+shift+z"}'
        echo '{"key": "ctrl+z"}'
        echo '{"expect": {"undo": "", "dirty": false}}'
        echo '{"scale": 1.5}'
        echo '{"scale": 1}'
        echo '{"resize": "700x420"}'
    done
    echo '{"drop": "scene.ivory.json"}'
    echo '{"wait": "final"}'
    echo '{"screenshot": "last.png", "viewport": true}'
    echo '{"save": "last.ivory.json"}'
} >rounds.script

if ! "$ivory" scene.ivory.json --headless --size 700x420 --threads 2 --script rounds.script 2>message; then
    cat message
    if [[ -z ${IVORY_REQUIRE_OPENGL-} ]] && grep -q "needs OpenGL in memory" message; then
        echo "SKIPPED: no OpenGL in memory"
        exit 77
    fi
    exit 1
fi
cmp first.png last.png
size=$(python3 -c '
import struct
print("%dx%d" % struct.unpack(">II", open("last.png", "rb").read()[16:24]))')
"$ivory" render last.ivory.json -o render.png --quiet --size "$size"
cmp last.png render.png
for edited in edited-*.png; do
    if cmp -s first.png "$edited"; then
        echo "$edited shows no edit"
        exit 1
    fi
    cmp edited-1.png "$edited"
done
echo "$rounds rounds"
