#!/usr/bin/env bash
# The hardware-in-the-loop test: hil.sh [--prepare] SCREE [WORK]
#
# The simulated scanner of SCREE sits at an emulated USB port of a Debian guest (QEMU without KVM). There the real drivers
# acquire its bulk frames and its V4L2 images, map them and publish to a client, while a script unplugs, stalls and
# corrupts the device. check.py then judges what came out: the map against the terrain that was rendered, and every fault.
# WORK (default build/hil) keeps the kernel's package, WORK-guest the guest's build. With --prepare that is all
# that is done. Exit codes: 0 good, 1 not, 77 skipped: something is missing, and the line SKIPPED says what.
set -euo pipefail
here=$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")
root=$(dirname "$(dirname "$here")")
prepare_only=
[ "${1:-}" = --prepare ] && { prepare_only=1; shift; }
[ $# -ge 1 ] || { echo "usage: hil.sh [--prepare] SCREE [WORK]" >&2; exit 64; }
scree=$(readlink -f "$1")
work=$(readlink -m "${2:-$root/build/hil}")
export PATH=$PATH:/usr/sbin:/sbin

terrain=fbm:2.3,0.05,7,20,0.02
place=line:0,0,0,0.05,1
sensor=depth-small
longest_s=180  # that the test may take once all is built

skip() {
  echo "SKIPPED: $*"
  exit 77
}

check_tools() {
  local tool
  for tool in qemu-system-x86_64 modprobe depmod cpio gzip dpkg-deb python3 cmake; do
    command -v "$tool" >/dev/null || skip "$tool is not installed"
  done
  [ -x /bin/busybox ] && [ -z "$(ldd /bin/busybox 2>/dev/null | grep '=>')" ] || skip "busybox-static is not installed"
  [ "$(uname -m)" = x86_64 ] || skip "the guest is made of this machine's libraries and must be x86_64, this is $(uname -m)"
  [[ $(ldd "$scree") == *usbredirparser* ]] || skip "$scree was built without SCREE_WITH_USBREDIR"
}

# The guest has no use for GDAL, PCL and OpenCV, which come with some 170 libraries.
build_guest() {
  cmake -G Ninja -S "$root" -B "$work-guest" -DCMAKE_BUILD_TYPE=Release -DSCREE_WITH_GDAL=OFF -DSCREE_WITH_PCL=OFF \
    -DSCREE_WITH_PICTURES=OFF -DSCREE_WITH_USBREDIR=OFF -DSCREE_BUILD_TESTS=OFF >"$work-guest.log"
  cmake --build "$work-guest" --target scree >>"$work-guest.log" || { tail -n 30 "$work-guest.log" >&2; return 1; }
  c++ -std=c++17 -O2 -Wall -Wextra -I "$root" -o "$work/client_log" "$here/client_log.cpp"
}

# What the scanner will see, its truth, and the guest's configuration made of it.
make_scene() {
  "$work-guest/scree" simulate --terrain "$terrain" --sensor "$sensor" --trajectory "$place" --noise off \
    --out "$run/scene" 2>"$run/scene.log"
  mkdir -p "$run/files"
  python3 "$here/guest_config.py" "$run/scene" >"$run/files/guest.yaml"
  "$work-guest/scree" replay "$run/scene" --config "$run/files/guest.yaml" --map-out "$run/replay.npy" \
    --set publish.destination=127.0.0.1:9 --set publish.listen=127.0.0.1:0 2>>"$run/scene.log"
  cp "$here/session" "$run/files/"
  python3 "$here/faults.py" --last "$here/faults.txt" >"$run/files/last_fault_s"
}

# Both stop by themselves: the guest powers off, the simulator's --duration ends.
run_guest() {
  local socket status=0 simulator
  socket=$(mktemp -u /tmp/scree-hil-XXXXXX)
  "$scree" simulate --terrain "$terrain" --sensor "$sensor" --trajectory "$place" --drive 127.0.0.1:0 --noise off \
    --serve "usbredir:$socket" --faults "$here/faults.txt" --duration 150 --json >"$run/simulator.json" 2>"$run/simulator.log" &
  simulator=$!
  timeout --kill-after=5 140 qemu-system-x86_64 -accel tcg,thread=multi -cpu Nehalem -smp 2 -m 512 \
    -nodefaults -no-user-config -nographic -no-reboot -serial "file:$run/guest.log" \
    -kernel "$(echo "$work"/kernel/boot/vmlinuz*)" -initrd "$run/initrd.gz" \
    -append "console=ttyS0 panic=-1 quiet mitigations=off" \
    -chardev "socket,id=usb,path=$socket,server=on,wait=off" -device qemu-xhci -device usb-redir,chardev=usb \
    -chardev "file,id=findings,path=$run/findings.tar" -device virtio-serial-pci \
    -device virtserialport,chardev=findings 2>"$run/qemu.log" || status=$?
  kill -INT "$simulator" 2>/dev/null || true
  wait "$simulator" || { echo "hil: the simulator ended with $?" >&2; cat "$run/simulator.log" >&2; return 1; }
  rm -f "$socket"
  [ "$status" -eq 0 ] || { echo "hil: QEMU ended with $status (124 = it took too long)" >&2; tail -n 20 "$run/guest.log" >&2; return 1; }
  tar -x -C "$run" -f "$run/findings.tar" || { echo "hil: no findings came out of the guest" >&2; tail -n 20 "$run/guest.log" >&2; return 1; }
}

mkdir -p "$work"
check_tools
"$here/kernel.sh" "$work" || skip "the kernel's package cannot be had"
build_guest
[ -z "$prepare_only" ] || exit 0

begin=$(date +%s)
run=$work/run
rm -rf "$run"
mkdir -p "$run"
make_scene
"$here/initramfs.sh" "$work/kernel" "$run/files" "$run/initrd.gz" "$work-guest/scree" "$work/client_log"
run_guest
python3 "$here/check.py" "$run" "$here/faults.txt"
took_s=$(($(date +%s) - begin))
echo "hil: $took_s s after the build"
[ "$took_s" -lt "$longest_s" ] || { echo "FAILED hil: expected less than $longest_s s after the build, found $took_s"; exit 1; }
