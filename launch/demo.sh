#!/usr/bin/env bash
# `./dev demo`: a simulated drive over natural-looking terrain, mapped, received over UDP, left as a picture.
set -euo pipefail
mkdir -p "$PWD/build"
exec "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/simulate_node_listen.sh" "$PWD/build/demo.png" "$@"
