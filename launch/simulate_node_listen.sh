#!/usr/bin/env bash
# The simulated scanner drives, the node maps, a listener leaves a picture.
set -euo pipefail
source "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/common.sh"

usage() {
  cat <<TEXT
simulate_node_listen.sh [PICTURE.png] [-- more options of scree replay]

Renders a short drive of the simulated scanner into a recording, replays it through the
node, receives the map over UDP on the loopback and leaves a picture (default
scree_simulated.png), whose path is printed last.

  environment: SCREE (the binary), SCREE_ADDRESS (default 127.0.0.1:47800),
    SCREE_TERRAIN, SCREE_SENSOR, SCREE_TRAJECTORY as for scree simulate,
    SCREE_RECORDING (keep the recording there; default a temporary directory)
TEXT
}

case "${1:-}" in
  -h|--help) usage; exit 0 ;;
esac
picture=$PWD/scree_simulated.png
if [ $# -gt 0 ] && [ "$1" != -- ]; then picture=$(realpath -m "$1"); shift; fi
[ "${1:-}" = -- ] && shift
address=${SCREE_ADDRESS:-127.0.0.1:47800}

recording=${SCREE_RECORDING:-}
if [ -z "$recording" ]; then
  temporary=$(mktemp -d)
  recording=$temporary/recording
fi
"$scree" simulate \
  --terrain "${SCREE_TERRAIN:-fbm:2.3,0.12,7,50,0.05}" \
  --sensor "${SCREE_SENSOR:-perceptron-cmu}" \
  --trajectory "${SCREE_TRAJECTORY:-arc:-4,-6,20,9,75,1.0}" \
  --out "$recording"

start_listener "$picture"
"$scree" replay "$recording" --rate max --config "$config_dir/demo.yaml" --set "publish.destination=$address" "$@"
finish_listener "$picture"
