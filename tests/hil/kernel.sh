#!/usr/bin/env bash
# kernel.sh WORK: WORK/kernel becomes what the guest takes from Debian's packages of the kernel and of udev: downloaded and
# unpacked, not installed. Done once. Fails when apt has neither network nor the packages.
set -euo pipefail
work=$1
[ ! -e "$work/kernel/complete" ] || exit 0

rm -rf "$work/download" "$work/kernel"
mkdir -p "$work/download" "$work/kernel"

download() {
  package=$(apt-cache depends linux-image-amd64 2>/dev/null | awk '$1 == "Depends:" { print $2; exit }')
  [ -n "$package" ] || { echo "hil: apt knows no linux-image-amd64" >&2; return 1; }
  (cd "$work/download" && timeout 300 apt-get -qq -o APT::Sandbox::User=root download "$package" udev) >&2 ||
    { echo "hil: apt-get could not download $package and udev" >&2; return 1; }
}
# a machine that had nothing to install may have no lists, or old ones
download || { timeout 300 apt-get -o DPkg::Lock::Timeout=300 -qq update >&2 && download; }

unpack() { dpkg-deb --fsys-tarfile "$1" | tar -x -C "$work/kernel" --wildcards "${@:2}"; }
modules='./lib/modules/*/kernel/drivers'
unpack "$work"/download/linux-image-*.deb './boot/vmlinuz*' './lib/modules/*/modules.*' "$modules/usb" "$modules/media" \
  "$modules/virtio" "$modules/char" './lib/modules/*/kernel/net/sched' "$modules/net/veth.ko"
unpack "$work"/download/udev_*.deb ./bin/udevadm
depmod -b "$work/kernel" "$(basename "$work"/kernel/lib/modules/*)"
rm -rf "$work/download"
touch "$work/kernel/complete"
