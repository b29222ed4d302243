#!/usr/bin/env bash
# `./dev demo`: a simulated drive over natural-looking terrain, mapped, received over UDP, left as a picture.
set -euo pipefail
mkdir -p "$PWD/build"
export SCREE_ADDRESS=${SCREE_ADDRESS:-127.0.0.1:0}  # any free port: a node may be running here already
exec "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/simulate_node_listen.sh" "$PWD/build/demo.png" "$@"
