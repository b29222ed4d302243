#!/bin/sh
# GRASS: regularised spline with tension. Tension 100 is the best of 40 (the default), 100, 200 and 400 on such samples;
# smoothing 0 goes through them.
set -eu
command -v grass >/dev/null || { echo "grass is not installed"; exit 77; }
cd "$1"
read -r rows columns cell rest <problem.txt
cat >grass-commands.sh <<COMMANDS
set -e
g.region n=$(awk "BEGIN { printf \"%.9g\", $rows * $cell }") s=0 e=$(awk "BEGIN { printf \"%.9g\", $columns * $cell }") w=0 res=$cell --q
v.in.ascii in=samples.xyz out=samples x=1 y=2 z=3 -z separator=space --q
begin=\$(date +%s.%N)
v.surf.rst input=samples elevation=surface tension=100 smooth=0 dmin=$(awk "BEGIN { print 0.1 * $cell }") --q
end=\$(date +%s.%N)
awk "BEGIN { print \$end - \$begin }" >grass-rst.seconds
r.out.ascii input=surface output=grass-rst.asc precision=9 --o --q
COMMANDS
grass --tmp-location XY --exec sh grass-commands.sh >grass.log 2>&1 || { cat grass.log >&2; exit 1; }
# six lines of header, then rows from the largest y
tail -n +7 grass-rst.asc | tac | tr -s ' ' '\n' | sed '/^$/d' >grass-rst.txt
