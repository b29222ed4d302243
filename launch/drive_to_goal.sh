#!/usr/bin/env bash
# A simulated robot drives to a goal: simulator ⇄ node ⇄ planner, over real sockets.
set -euo pipefail
source "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/common.sh"

usage() {
  cat <<TEXT
drive_to_goal.sh [PICTURE.png] [-- more options of scree plan]

Serves the simulated scanner on a robot that can be driven, maps with scree run, lets
the example planner drive to the goal, and leaves a picture of the way over the true
terrain (default scree_way.png), whose path is printed last. What the true ground asked
of the vehicle is said on standard error.

  environment: SCREE (the binary), SCREE_TERRAIN, SCREE_SENSOR (default lidar64),
    SCREE_START (default line:-6,0,0,0,1), SCREE_GOAL (default 6,0)
TEXT
}

case "${1:-}" in
  -h|--help) usage; exit 0 ;;
esac
picture=$PWD/scree_way.png
if [ $# -gt 0 ] && [ "$1" != -- ]; then picture=$(realpath -m "$1"); shift; fi
[ "${1:-}" = -- ] && shift
terrain=${SCREE_TERRAIN:-fbm:2.4,0.12,3,30,0.05}
temporary=$(mktemp -d)
stream=unix:$temporary/scanner.sock
simulator_log=$temporary/simulator.log
node_log=$temporary/node.log
listener_log=$simulator_log  # common.sh ends what is named so
config=(--config "$config_dir/demo.yaml")

# wait_for LOG WORDS PID: prints what follows WORDS in the log, or shows the log of a process that ended.
wait_for() {
  for _ in $(seq 200); do
    if grep -q "$2" "$1"; then sed -n "s/.*$2//p" "$1" | head -n 1; return; fi
    kill -0 "$3" 2>/dev/null || break
    sleep 0.05
  done
  cat "$1" >&2
  exit 69
}

"$scree" simulate --terrain "$terrain" --sensor "${SCREE_SENSOR:-lidar64}" \
  --trajectory "${SCREE_START:-line:-6,0,0,0,1}" --frame-period 0.2 "${config[@]}" \
  --serve "$stream" --drive 127.0.0.1:0 --json >"$temporary/report.json" 2>"$simulator_log" &
listener=$!
wheels=$(wait_for "$simulator_log" "driven at " "$listener")
"$scree" run "${config[@]}" --set source.kind=stream --set "source.address=$stream" \
  --set publish.destination=127.0.0.1:9 --set node.threads=2 2>"$node_log" &
node=$!
address=$(wait_for "$node_log" "listening at " "$node")
code=0
"$scree" plan --goal "${SCREE_GOAL:-6,0}" --node "$address" --drive "$wheels" --accept live,sim --terrain "$terrain" \
  --picture "$picture" "$@" || code=$?
kill -INT "$node" "$listener" 2>/dev/null || true
wait "$node" || true
wait "$listener" || true
node='' listener=''
grep -E '"(path_m|violated_m|pitch_max_rad|roll_max_rad|step_max_m)"' "$temporary/report.json" >&2 || cat "$simulator_log" >&2
[ "$code" -eq 0 ] || exit "$code"
echo "$picture"
