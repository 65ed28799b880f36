#!/usr/bin/env bash
# The container of deploy/Containerfile: its command starts as its user, without capabilities and on a file system that is read
# only, is healthy, solves, and ends with status 0; the compose file's command wants a token first.
#
#     container.sh BELTFLOW.deb             in a view of this machine (tests/deploy/view.sh), which has no base image
#     container.sh --build BELTFLOW.deb     in an image that buildah makes of Debian and the package, by hand, some two minutes:
#                                           both, buildah and Debian, come from Debian's mirror into the view
#
# exit 77: cannot be tried here
set -euo pipefail

export DEBIAN_FRONTEND=noninteractive LC_ALL=C

fail()
{
    echo "container: $*" >&2
    exit 1
}

# words KEYWORD: what that instruction of the last stage, or the compose file's command, says, a word a line.
words()
{
    python3 - "$1" <<'END'
import re, sys
if sys.argv[1] == "compose":
    found = re.search(r"^ *command: \[(.*)\]$", open("/compose.yaml").read(), re.MULTILINE)[1].split(", ")
    words = [word.strip('"') for word in found]
else:
    stage = open("/Containerfile").read().replace("\\\n", "").split("\nFROM ")[-1]
    text = re.search(rf"^{sys.argv[1]} (.*)$", stage, re.MULTILINE)[1]
    text = text[text.index(" CMD ") + 5:] if sys.argv[1] == "HEALTHCHECK" else text
    words = __import__("json").loads(text) if text.startswith("[") else [text]
print("\n".join(words))
END
}

start()
{
    "${within[@]}" "$@" >/tmp/log 2>&1 &
    daemon=$!
    for _ in $(seq 1200); do
        "${within[@]}" "${health[@]}" 2>/dev/null && return
        kill -0 "$daemon" 2>/dev/null || break
        sleep 0.05
    done
    fail "it is not healthy: $(cat /tmp/log)"
}

stop()
{
    kill -TERM "$daemon"
    wait "$daemon" || fail "it left with $?: $(cat /tmp/log)"
}

ask()
{
    curl -sS --fail --max-time 60 "${@:2}" "http://127.0.0.1:8080$1"
}

# In a network of its own, as the ports are the shipped ones: the container's root is $1.
if [[ ${1:-} == --drive ]]; then
    ip link set lo up
    # As the container's processes are.
    within=(chroot /container setpriv --reuid="$(words USER)" --regid="$(words USER)" --clear-groups --no-new-privs
        --bounding-set=-all)
    mapfile -t health < <(words HEALTHCHECK)
    mapfile -t command < <(words CMD)
    mapfile -t compose < <(words compose)
    mkdir -p /container
    mount --bind "$2" /container
    mount -o remount,bind,ro /container
    mount --bind "$2$(words VOLUME)" "/container$(words VOLUME)"
    for folder in proc dev tmp; do
        mount --rbind "/$folder" "/container/$folder"
    done

    "${within[@]}" "${health[@]}" 2>/dev/null && fail "it is healthy without a daemon"
    start "${command[@]}"
    ask /v1/examples/free-belt -o /tmp/scenario.json
    echo "{\"scenario\": $(cat /tmp/scenario.json)}" >/tmp/run.json
    run=$(ask /v1/runs -o /dev/null -w '%header{location}' -H 'Content-Type: application/json' --data-binary @/tmp/run.json)
    run=/v1${run#*/v1}
    ask "$run/events" -N >/tmp/events
    ask "$run" | grep '"status": *"succeeded"' >/dev/null || fail "a run did not succeed"
    stop

    status=0
    "${within[@]}" "${compose[@]}" >/tmp/log 2>&1 || status=$?
    ((status == 2)) || fail "without a token the compose file's command left with $status: $(cat /tmp/log)"
    token=$("${within[@]}" beltflowd --data "$(words VOLUME)" token add alice 2>/tmp/log) || fail "$(cat /tmp/log)"
    start "${compose[@]}"
    ask "$run" -o /dev/null 2>/dev/null && fail "strangers are let in"
    ask /v1/runs -H "Authorization: Bearer $token" >/dev/null
    stop
    exit 0
fi

if [[ ${1:-} == --inside && -e /build ]]; then
    { apt-get update -q && apt-get install -y -q --no-install-recommends buildah mmdebstrap; } >/tmp/log 2>&1 || fail "$(cat /tmp/log)"
    mmdebstrap --quiet --variant=minbase bookworm /tmp/debian.tar
    mkdir -p /tmp/stage/src/build/package
    cp /beltflow.deb /tmp/stage/src/build/package
    printf '[storage]\ndriver = "vfs"\ngraphroot = "/tmp/images"\nrunroot = "/run/images"\n' >/tmp/storage.conf
    export CONTAINERS_STORAGE_CONF=/tmp/storage.conf BUILDAH_ISOLATION=chroot TMPDIR=/tmp
    base=$(buildah from scratch)
    buildah add --quiet "$base" /tmp/debian.tar / >/dev/null
    buildah commit --quiet "$base" docker.io/library/debian:12-slim >/dev/null
    # What the first stage makes is there already.
    buildah build --quiet --pull-never --format docker --build-context build=/tmp/stage -t beltflow -f /Containerfile /tmp/stage >/tmp/log 2>&1 ||
        fail "$(cat /tmp/log)"
    root=$(buildah mount "$(buildah from --pull-never beltflow)")
    unshare --net --mount bash "$0" --drive "$root"
    echo "container: built by buildah, started, healthy, stopped; with tokens, too"
    exit 0
fi
if [[ ${1:-} == --inside ]]; then
    rm -f /var/lib/man-db/auto-update
    dpkg --install /*.deb >/tmp/log 2>&1 || fail "$(cat /tmp/log)"
    unshare --net bash "$0" --drive /
    echo "container: NOT built; started, healthy, stopped in a view of this machine; with tokens, too"
    exit 0
fi

folder=$(dirname "$0")
files=("$folder/../../deploy/Containerfile" "$folder/../../deploy/compose.yaml")
space=$(mktemp -d)
trap 'rm -r "$space"' EXIT
if [[ ${1:-} == --build ]]; then
    touch "$space/build"
    files+=("$space/build")
    shift
fi
cp "${1:?usage: container.sh [--build] BELTFLOW.deb}" "$space/beltflow.deb"
"$folder/view.sh" "$0" "${files[@]}" "$space/beltflow.deb"
