#!/usr/bin/env bash
# lintian has nothing to say of the Debian package; it installs, its daemon starts as its own user and solves, an upgrade from
# an earlier package keeps runs and settings, and purging leaves nothing. All in a view of this machine (tests/deploy/view.sh).
# Without a package of an earlier version it is this one under an earlier number: its scripts and conffiles are tried, no migration.
#
#     package.sh BELTFLOW.deb [EARLIER.deb]        exit 77: cannot be tried here
set -euo pipefail

fail()
{
    echo "package: $*" >&2
    exit 1
}

# In the view, with the package as /beltflow.deb, and under an earlier number as /earlier.deb.
if [[ ${1:-} == --inside ]]; then
    export DEBIAN_FRONTEND=noninteractive LC_ALL=C
    work=$(mktemp -d)
    rm -f /var/lib/man-db/auto-update # else each installation indexes all manual pages of this machine

    start_daemon()
    {
        : >"$work/out"
        setpriv --reuid=beltflow --regid=beltflow --clear-groups \
            beltflowd --config /etc/beltflow/beltflow.conf --listen 127.0.0.1:0 \
            >"$work/out" 2>"$work/log" &
        daemon=$!
        for _ in $(seq 1200); do
            url=$(sed -n 's/.* listening on \(http[^ ]*\)\/$/\1/p' "$work/out")
            [[ -n $url ]] && return
            kill -0 "$daemon" 2>/dev/null || break
            sleep 0.05
        done
        fail "the daemon did not start: $(cat "$work/log")"
    }

    stop_daemon()
    {
        kill -TERM "$daemon"
        wait "$daemon" || fail "the daemon left with $?"
    }

    dpkg --install /earlier.deb >"$work/dpkg" 2>&1 || fail "$(cat "$work/dpkg")"
    getent passwd beltflow >/dev/null || fail "there is no user beltflow"
    [[ $(stat -c '%U %a' /var/lib/beltflow) == "beltflow 750" ]] || fail "/var/lib/beltflow is open"
    setpriv --reuid=beltflow --regid=beltflow --clear-groups \
        beltflowd --config /etc/beltflow/beltflow.conf --check-config || fail "the settings are at fault"

    start_daemon
    curl -sS --fail -o /dev/null "$url/readyz"
    curl -sS --fail -o "$work/scenario.json" "$url/v1/examples/free-belt"
    echo "{\"scenario\": $(cat "$work/scenario.json")}" >"$work/body.json"
    run=$(curl -sS --fail -o /dev/null -w '%header{location}' -H 'Content-Type: application/json' \
        --data-binary "@$work/body.json" "$url/v1/runs")
    run=${run#"$url"}
    curl -sSN --max-time 60 "$url$run/events" >"$work/events"
    curl -sS --fail "$url$run" | grep -q '"status": *"succeeded"' || fail "the run did not succeed"
    stop_daemon

    echo "retention_days = 30" >>/etc/beltflow/beltflow.conf
    # The operator's settings stay where the sample has changed, too: what is answered to dpkg's question.
    dpkg --force-confold --install /beltflow.deb >"$work/dpkg" 2>&1 || fail "again: $(cat "$work/dpkg")"
    grep -q "upgraded\|over (" "$work/dpkg" || fail "no upgrade: $(cat "$work/dpkg")"
    grep -qx "retention_days = 30" /etc/beltflow/beltflow.conf || fail "an upgrade lost the settings"
    [[ "beltflowd $(dpkg-query -W -f='${Version}' beltflow)" == "$(beltflowd --version)-1" ]] ||
        fail "the program is $(beltflowd --version)"
    dpkg --listfiles beltflow >"$work/files"
    for file in /usr/bin/beltflow /usr/bin/beltflow-worker /usr/bin/beltflowd /lib/systemd/system/beltflow.service \
        /lib/systemd/system/beltflow-backup.service /lib/systemd/system/beltflow-backup.timer \
        /etc/beltflow/beltflow.conf /usr/share/man/man8/beltflowd.8.gz /usr/share/man/man1/beltflow-solve.1.gz \
        /usr/share/doc/beltflow/copyright /usr/share/doc/beltflow/manual/operating.md; do
        grep -qx "$file" "$work/files" || fail "$file is not in the package"
    done
    start_daemon
    curl -sS --fail "$url$run" | grep -q '"status": *"succeeded"' || fail "an upgrade lost the run"
    stop_daemon

    # As root, with the packaged settings: a token that the daemon knows, a copy, and the copy in its place.
    token=$(beltflowd token add root --scopes admin 2>"$work/log") || fail "$(cat "$work/log")"
    [[ $(stat -c %U /var/lib/beltflow/access.db) == beltflow ]] || fail "the tokens are not the daemon's"
    beltflowd backup /var/backups/beltflow --copies 7 >"$work/copy" || fail "no copy"
    copy=$(sed 's/: .*//' "$work/copy")
    rm -rf /var/lib/beltflow/* /etc/beltflow/beltflow.conf
    beltflowd --config /etc/beltflow/beltflow.conf --data /var/lib/beltflow restore "$copy" >"$work/log" 2>&1 ||
        fail "$(cat "$work/log")"
    grep -qx "retention_days = 30" /etc/beltflow/beltflow.conf || fail "the settings did not come back"
    start_daemon
    curl -sS --fail -H "Authorization: Bearer $token" "$url$run" | grep -q '"status": *"succeeded"' ||
        fail "the copy has not the run"
    [[ $(curl -sS -o /dev/null -w '%{http_code}' "$url$run") == 401 ]] || fail "a restored store lets strangers in"
    stop_daemon

    dpkg --purge beltflow >"$work/dpkg" 2>&1 || fail "$(cat "$work/dpkg")"
    [[ -e /var/lib/beltflow/beltflow.db ]] || fail "purging removed the store, unasked"
    dpkg --install /beltflow.deb >"$work/dpkg" 2>&1 || fail "after purging: $(cat "$work/dpkg")"
    [[ -L /etc/systemd/system/multi-user.target.wants/beltflow.service ]] || fail "the unit is not enabled"
    echo "beltflow beltflow/remove-store boolean true" | debconf-set-selections
    dpkg --purge beltflow >"$work/dpkg" 2>&1 || fail "$(cat "$work/dpkg")"
    while read -r file; do
        [[ -d $file || ! -e $file ]] || fail "purging left $file"
    done <"$work/files"
    for file in /var/lib/beltflow /etc/beltflow /etc/systemd/system/multi-user.target.wants/beltflow.service; do
        [[ ! -e $file ]] || fail "purging left $file"
    done
    [[ -e $copy ]] || fail "purging removed the copies"
    getent passwd beltflow >/dev/null || fail "purging removed the user, whose the copies are"
    exit 0
fi

deb=$(realpath "${1:?usage: package.sh BELTFLOW.deb [EARLIER.deb]}")
lintian --allow-root --fail-on error,warning "$deb" || fail "lintian found this"
space=$(mktemp -d)
trap 'rm -r "$space"' EXIT
cp "$deb" "$space/beltflow.deb"
if (($# > 1)); then
    cp "$2" "$space/earlier.deb"
else
    dpkg-deb --raw-extract "$deb" "$space/earlier"
    sed -i 's/^Version: .*/Version: 0.1.0/' "$space/earlier/DEBIAN/control"
    dpkg-deb -Znone --build "$space/earlier" "$space/earlier.deb" >/dev/null
fi
"$(dirname "$0")/view.sh" "$0" "$space/beltflow.deb" "$space/earlier.deb"
echo "package: installed, started, upgraded, purged"
