#!/usr/bin/env bash
# command_test.sh IVORY REFEREE WORK: answers of a run are right; a falsified one is named.
set -euo pipefail
ivory=$1 referee=$2 work=$3
mkdir -p "$work"
cd "$work"
cat >scene.json <<'END'
{"ivory": 1, "threshold": 0.5, "elements": [
  {"shape": "point", "position": [0, 0, 0]},
  {"shape": "curve", "control_points": [[-1, 0, 0], [0, 2, 0], [1, 0, 1]], "kernel": "wyvill"}]}
END
printf '%s\n' '-9 0 0 1 0 0' '-9 0.25 0 1 0 0' '-9 7 0 1 0 0' >rays.txt
"$ivory" trace scene.json --rays rays.txt >answers.csv
"$referee" scene.json answers.csv --rays rays.txt | grep -q '^right 3, wrong 0,'
"$ivory" render scene.json -o picture.png --size 16x9 --answers picture.csv
"$referee" scene.json picture.csv | grep -q '^right 144, wrong 0,'

sed '3s/.*/miss,,,,,,,,/' answers.csv >false.csv
status=0
"$referee" scene.json false.csv --rays rays.txt >told.txt || status=$?
[[ $status == 1 ]]
grep -q '^line 3: wrong, wrong miss; ray -0x1.2p+3 ' told.txt
grep -q '^right 2, wrong 1,' told.txt
