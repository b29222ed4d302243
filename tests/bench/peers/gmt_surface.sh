#!/bin/sh
# GMT's continuous-curvature splines, tension 0.25 as its manual advises for topography.
set -eu
command -v gmt >/dev/null || { echo "gmt is not installed"; exit 77; }
cd "$1"
read -r rows columns cell rest <problem.txt
x_max=$(awk "BEGIN { printf \"%.9g\", $columns * $cell }")
y_max=$(awk "BEGIN { printf \"%.9g\", $rows * $cell }")
begin=$(date +%s.%N)
gmt surface samples.xyz -R0/"$x_max"/0/"$y_max" -I"$cell" -r -T0.25 -Ggmt-surface.nc
end=$(date +%s.%N)
gmt grd2xyz gmt-surface.nc -ZBLa >gmt-surface.txt
awk "BEGIN { print $end - $begin }" >gmt-surface.seconds
