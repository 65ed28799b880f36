#!/usr/bin/env bash
# A view of this machine of its own, whose changes are thrown away: files, mounts, devices and processes. SCRIPT runs in it
# as its first process, with the argument --inside; the FILEs lie in / there.
#
#     view.sh SCRIPT FILE...        exit 77: there can be none here (not root, no overlay file system)
set -euo pipefail

if ((EUID != 0)) || ! unshare --mount true; then
    echo "view: skipped, not root"
    exit 77
fi
files=()
for file; do
    files+=("$(realpath "$file")")
done
space=$(mktemp -d)
trap 'rm -r "$space"' EXIT
# shellcheck disable=SC2016 # the inner shell expands it
unshare --mount --pid --fork bash -euc '
    mount -t tmpfs none "$0"
    cd "$0"
    mkdir up work root
    if ! mount -t overlay overlay -o "lowerdir=/,upperdir=$0/up,workdir=$0/work" root; then
        echo "view: skipped, no overlay file system"
        exit 77
    fi
    cp "$@" root
    cd root
    mount -t proc proc proc
    mount --bind proc/sys proc/sys
    mount -o remount,bind,ro proc/sys
    mount -t sysfs -o ro sysfs sys
    mount -t tmpfs none tmp
    mount -t tmpfs none run
    mount -t tmpfs -o mode=755 none dev
    cp -a /dev/{null,zero,full,random,urandom,tty} dev
    mkdir dev/shm dev/pts
    mount -t devpts -o newinstance,ptmxmode=666 none dev/pts
    ln -s /proc/self/fd dev/fd
    ln -s pts/ptmx dev/ptmx
    mkdir old
    pivot_root . old # and not chroot: there, nobody may make namespaces of users
    umount -l old
    rmdir old
    exec bash "/$(basename "$1")" --inside' "$space" "${files[@]}"
