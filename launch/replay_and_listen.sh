#!/usr/bin/env bash
# A recording through the node to a listener, which leaves a picture.
set -euo pipefail
source "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/common.sh"

usage() {
  cat <<TEXT
replay_and_listen.sh RECORDING [PICTURE.png] [-- more options of scree replay]

Replays a recording directory or range file, receives its map over UDP on the loopback
and leaves a picture (default scree_map.png), whose path is printed last.

  replay_and_listen.sh drive/ map.png -- --rate max --set map.cell_m=0.2
  environment: SCREE (the binary), SCREE_ADDRESS (default 127.0.0.1:47800)
TEXT
}

case "${1:-}" in
  -h|--help) usage; exit 0 ;;
  ''|--) usage >&2; exit 64 ;;
esac
recording=$1
shift
picture=$PWD/scree_map.png
if [ $# -gt 0 ] && [ "$1" != -- ]; then picture=$(realpath -m "$1"); shift; fi
[ "${1:-}" = -- ] && shift
address=${SCREE_ADDRESS:-127.0.0.1:47800}

start_listener "$picture"
"$scree" replay "$recording" --set "publish.destination=$address" --set publish.listen=127.0.0.1:0 "$@"
finish_listener "$picture"
