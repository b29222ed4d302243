#!/bin/sh
# GMT's continuous-curvature splines, tension 0.25 as its manual advises for topography.
set -eu
command -v gmt >/dev/null || { echo "gmt is not installed"; exit 77; }
cd "$1"
read -r rows columns cell rest <problem.txt
# Nodes at the cells' centres: with pixel registration (-r) version 6.4 returns a surface that misses its own data.
low=$(awk "BEGIN { printf \"%.9g\", 0.5 * $cell }")
x_high=$(awk "BEGIN { printf \"%.9g\", ($columns - 0.5) * $cell }")
y_high=$(awk "BEGIN { printf \"%.9g\", ($rows - 0.5) * $cell }")
begin=$(date +%s.%N)
gmt surface samples.xyz -R"$low"/"$x_high"/"$low"/"$y_high" -I"$cell" -T0.25 -Ggmt-surface.nc
end=$(date +%s.%N)
gmt grd2xyz gmt-surface.nc -ZBLa >gmt-surface.txt
awk "BEGIN { print $end - $begin }" >gmt-surface.seconds
