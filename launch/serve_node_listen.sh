#!/usr/bin/env bash
# The simulated scanner as a live device, the node that acquires from it, a listener that leaves a picture.
set -euo pipefail
source "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/common.sh"

usage() {
  cat <<TEXT
serve_node_listen.sh [PICTURE.png] [-- more options of scree run]

Serves the simulated scanner as a live device in real time, runs the node on its frame
stream, receives the map over UDP on the loopback and leaves a picture (default
scree_live.png), whose path is printed last. On a terminal a line shows how far the
drive is; the node's own lines are shown if it fails.

  environment: SCREE (the binary), SCREE_ADDRESS (default 127.0.0.1:47800),
    SCREE_TERRAIN, SCREE_SENSOR, SCREE_TRAJECTORY as for scree simulate
TEXT
}

case "${1:-}" in
  -h|--help) usage; exit 0 ;;
esac
picture=$PWD/scree_live.png
if [ $# -gt 0 ] && [ "$1" != -- ]; then picture=$(realpath -m "$1"); shift; fi
[ "${1:-}" = -- ] && shift
address=${SCREE_ADDRESS:-127.0.0.1:47800}
temporary=$(mktemp -d)
stream=unix:$temporary/scanner.sock
node_log=$temporary/node.log

# The node ends by itself only when something is wrong with it.
fail_with_node() {
  local code=0
  wait "$node" || code=$?
  node=
  cat "$node_log" >&2
  exit "$code"
}

start_listener "$picture"
"$scree" run --config "$config_dir/demo.yaml" --set source.kind=stream --set "source.address=$stream" \
  --set "publish.destination=$address" "$@" 2>"$node_log" &
node=$!
for _ in $(seq 100); do
  grep -q "trying again" "$node_log" && break  # it runs, and the device is not there yet
  kill -0 "$node" 2>/dev/null || fail_with_node
  sleep 0.05
done
"$scree" simulate \
  --terrain "${SCREE_TERRAIN:-fbm:2.3,0.12,7,50,0.05}" \
  --sensor "${SCREE_SENSOR:-perceptron-cmu}" \
  --trajectory "${SCREE_TRAJECTORY:-arc:-4,-6,20,9,75,1.0}" \
  --serve "$stream"
sleep 1  # for the last frame
kill -INT "$node" 2>/dev/null || fail_with_node
wait "$node" || fail_with_node
node=
tail -n 1 "$node_log" >&2
finish_listener "$picture"
