#!/usr/bin/env bash
# initramfs.sh KERNEL_TREE GUEST_FILES OUT PROGRAM…: packs a guest that runs tests/hil/init as its first process. KERNEL_TREE
# holds boot/, lib/modules/ and bin/udevadm as Debian's packages have them, GUEST_FILES what appears as /hil; each
# PROGRAM comes into /hil with the libraries that it needs.
set -euo pipefail
here=$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")
kernel=$(readlink -f "$1") files=$(readlink -f "$2") out=$(readlink -m "$3")
shift 3

root=$(mktemp -d)
trap 'rm -rf "$root"' EXIT
mkdir -p "$root"/{bin,dev,etc,hil,lib/systemd,lib/udev/rules.d,proc,root,run,sys,tmp}

# with_libraries FILE: whatever the loader says that it needs, where the loader looks for it.
with_libraries() {
  local library
  for library in $(ldd "$1" | grep -o '/[^ ]*' | sort -u); do
    [ -e "$root$library" ] || install -D -m 755 "$(readlink -f "$library")" "$root$library"
  done
}

cp /bin/busybox "$root/bin/busybox"
for applet in $(/bin/busybox --list); do [ "$applet" = busybox ] || ln -s busybox "$root/bin/$applet"; done
ln -sf ../bin "$root/sbin"

# udevadm is udevd when it is called so; libusb learns of arrivals from it.
cp "$kernel/bin/udevadm" "$root/lib/systemd/systemd-udevd"
with_libraries "$kernel/bin/udevadm"
ln -s ../lib/systemd/systemd-udevd "$root/bin/udevadm"

version=$(basename "$kernel"/lib/modules/*)
for module in xhci_pci uvcvideo virtio_pci virtio_console; do
  modprobe -d "$kernel" -S "$version" --show-depends "$module" | awk '$1 == "insmod" { print $2 }'
done | sort -u | while read -r file; do install -D -m 644 "$file" "$root/${file#"$kernel"/}"; done
cp "$kernel/lib/modules/$version"/modules.{order,builtin,builtin.modinfo} "$root/lib/modules/$version/"
depmod -b "$root" "$version"

for program in "$@"; do
  install -m 755 "$program" "$root/hil/$(basename "$program")"
  with_libraries "$program"
done
cp -r "$files"/. "$root/hil/"
install -m 755 "$here/init" "$root/init"

mkdir -p "$(dirname "$out")"
(cd "$root" && find . | cpio --quiet -o -H newc | gzip -1) >"$out"
echo "$(basename "$out"): $(du -h "$out" | cut -f1) for $(du -sh "$root" | cut -f1)"
