# shellcheck shell=bash disable=SC2034,SC2154
# Sourced by the launch files: finds the binary and the configurations, in a clone or installed.

launch_dir=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")" && pwd)
root=$(dirname "$launch_dir")
if [ -n "${SCREE:-}" ]; then
  scree=$SCREE
elif [ -x "$root/build/release/scree" ]; then  # a clone
  scree=$root/build/release/scree
else  # installed: PREFIX/share/scree/launch
  scree=$(readlink -f "$root/../../bin/scree" || true)
fi
if [ ! -x "$scree" ]; then
  echo "$(basename "$0"): no binary; build it with ./dev build, or set SCREE" >&2
  exit 69
fi
config_dir=$root/config

listener=
listener_log=
node=       # a process, and
temporary=  # a directory, that a launch file may set
clean_up() {
  [ -z "$node" ] || kill "$node" 2>/dev/null || true
  [ -z "$listener" ] || kill "$listener" 2>/dev/null || true
  [ -z "$listener_log" ] || rm -f "$listener_log"
  [ -z "$temporary" ] || rm -rf "$temporary"
}
trap clean_up EXIT

# start_listener PICTURE: a listener in the background that takes the picture; waits until it listens, and sets `address`
# to where (port 0 asks for any free one).
start_listener() {
  listener_log=$(mktemp)
  "$scree" listen --address "$address" --snapshot "$1" --duration "${limit_s:-600}" 2>"$listener_log" &
  listener=$!
  for _ in $(seq 100); do
    if grep -q "listening at" "$listener_log"; then
      address=$(sed -n 's/.*listening at //p' "$listener_log" | head -n 1)
      return
    fi
    kill -0 "$listener" 2>/dev/null || break
    sleep 0.05
  done
  cat "$listener_log" >&2
  exit 69
}

# finish_listener PICTURE: it ends by itself at the node's BYE.
finish_listener() {
  local code=0
  wait "$listener" || code=$?
  listener=
  cat "$listener_log" >&2
  [ "$code" -eq 0 ] || exit "$code"
  echo "$1"
}
