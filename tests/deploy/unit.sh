#!/usr/bin/env bash
# The package's units really started: systemd boots in a view of this machine (tests/deploy/view.sh), with namespaces and a
# control group of its own. The daemon starts confined, solves, survives a kill and drains; with the settings for the shipped
# nginx site it wants a token, and behind a real nginx it knows its users.
#
#     unit.sh BELTFLOW.deb        exit 77: cannot be tried here
set -euo pipefail
renice -n 0 "$$" >/dev/null # as systemd has: a trial's 10 cannot be had from 19, with which the tests may be run

# As the first process of the view: install, and become systemd, which starts its journal and what the package enables.
if [[ ${1:-} == --inside ]]; then
    export DEBIAN_FRONTEND=noninteractive LC_ALL=C
    units=/lib/systemd/system
    rm -rf /etc/systemd/system/*.wants $units/*.wants /etc/fstab /var/lib/man-db/auto-update
    mkdir $units/sysinit.target.wants
    ln -s ../systemd-journald.service $units/sysinit.target.wants
    dpkg --install /*.deb >/tmp/dpkg 2>&1 || { cat /tmp/dpkg && exit 1; }
    mount -t cgroup2 none /mnt
    echo 0 >"/mnt/$BELTFLOW_GROUP/cgroup.procs"
    umount /mnt
    # shellcheck disable=SC2016 # the inner shell expands it
    exec unshare --cgroup --net --ipc --uts bash -euc '
        mount -t cgroup2 none /sys/fs/cgroup
        bash "$0" --try &
        exec env -i container=view PATH="$PATH" /lib/systemd/systemd --log-target=journal --show-status=no' "$0"
fi

fail()
{
    journalctl --no-pager --quiet --unit beltflow --unit beltflow-backup | tail -n 40 >&2
    echo "unit: $*" >&2
    exit 1
}

# until_true WHAT COMMAND...: wait until the command succeeds.
until_true()
{
    local what=$1
    shift
    for _ in $(seq 1200); do
        "$@" >/dev/null 2>&1 && return
        sleep 0.05
    done
    fail "$what: not within a minute"
}

# logged TEXT: whether the daemon's log has it.
logged()
{
    journalctl --sync
    journalctl --quiet --unit beltflow | grep "$1" >/dev/null
}

property()
{
    systemctl show --property "$1" --value beltflow
}

# ask PATH [CURL'S ARGUMENTS...]: the body of an answer 2xx.
ask()
{
    curl -sS --fail-with-body --max-time 60 "${@:2}" "${base:-http://127.0.0.1:8080}$1"
}

# member NAME: its first value, a text or a number, in a document on stdin.
member()
{
    grep -oE "\"$1\": *(\"[^\"]*\"|[0-9]+)" | head -n 1 | sed -E 's/^[^:]*: *"?([^"]*)"?$/\1/'
}

run_is()
{
    [[ $(ask "/v1/runs/$run" | member status) == "$1" ]]
}

starts_confined()
{
    until_true "systemd" systemctl is-system-running --wait
    ask /readyz >/dev/null
    journalctl --no-pager --quiet --unit beltflow --priority warning _PID=1 | sed 's/^/unit: /'
    local status line
    status=/proc/$(property MainPID)/status
    for line in "CapEff: 0000000000000000" "CapBnd: 0000000000000000" "NoNewPrivs: 1" "Seccomp: 2"; do
        tr '\t' ' ' <"$status" | grep -qx "$line" || fail "the daemon has not $line"
    done
    [[ $(stat -c %U "$status") == beltflow ]] || fail "the daemon is $(stat -c %U "$status")"
    grep -q ' / / ro' "$(dirname "$status")/mountinfo" || fail "the daemon may write to /"
    # What the kernel has to confine solvers with, the unit leaves to them.
    beltflowd --data /tmp/plain --listen 127.0.0.1:0 >/tmp/plain.log 2>&1 &
    until_true "a daemon without the unit" grep -q event=started /tmp/plain.log
    kill %%
    logged "$(grep -o 'event=solvers_confined .*' /tmp/plain.log)" ||
        fail "under the unit solvers are less confined than $(cat /tmp/plain.log)"
}

# A run that does not end and a study of such runs, at a lower priority.
solves()
{
    local gate='{"from_m": [0.75, 0], "to_m": [0.75, 0.6]}'
    local cargo='{"shape": {"type": "cylinder", "radius_m": 0.012, "height_m": 0.008}}'
    local parts='{"hexagonal": {"rows": 16, "columns": 12, "first_m": [0.1, 0.11], "spacing_m": 0.02448}}'
    local scenario="{\"duration_s\": 200000, \"domain\": {\"x_m\": [0, 1], \"y_m\": [0, 0.6]}, \"obstacles\": [$gate],
        \"cargo\": $cargo, \"initial\": $parts, \"output\": {\"curve_every_s\": 1, \"snapshot_every_s\": 100},
        \"macro\": {\"cell_m\": 0.01, \"step_s\": 0.0025}}"
    echo "{\"scenario\": $scenario}" >/tmp/run.json
    echo "{\"base\": {\"scenario\": $scenario}, \"method\": {\"type\": \"grid\"}, \"objectives\": [{\"figure\": \"jam.count\"}],
        \"parameters\": [{\"pointer\": \"/duration_s\", \"values\": [100000, 200000, 300000]}]}" >/tmp/study.json
    run=$(ask /v1/runs -H 'Content-Type: application/json' --data-binary @/tmp/run.json | member id)
    study=$(ask /v1/studies -H 'Content-Type: application/json' --data-binary @/tmp/study.json | member id)
    until_true "the run" run_is running
    until_true "a trial at nice 10" bash -c 'ps -C beltflow-worker -o ni= | grep -x " *10"'
}

has_restarted()
{
    [[ $(property NRestarts) == 1 && $(property MainPID) != "$killed" ]] && ask /readyz
}

survives_a_kill()
{
    killed=$(property MainPID)
    systemctl kill --kill-whom=main --signal=KILL beltflow
    until_true "a new start" has_restarted
    until_true "the run goes on" run_is running
}

drains()
{
    systemctl stop beltflow
    [[ "$(property Result) $(property ExecMainCode) $(property ExecMainStatus)" == "success 1 0" ]] ||
        fail "the daemon left with $(property Result) $(property ExecMainCode) $(property ExecMainStatus)"
    systemctl start beltflow
    until_true "the run goes on" run_is running
    ask "/v1/runs/$run" -X DELETE
    ask "/v1/studies/$study/cancel" -X POST >/dev/null
    systemctl reload beltflow
    until_true "settings read" logged event=settings_read
}

copies()
{
    systemctl start beltflow-backup.service || fail "no copy"
    beltflowd verify /var/backups/beltflow/beltflow-*.db >/dev/null || fail "the copy is not whole"
    systemctl enable --quiet --now beltflow-backup.timer
    systemctl is-active --quiet beltflow-backup.timer || fail "the timer is not active"
}

# The site and the settings as they are shipped, and what an operator adds: a certificate and, once the daemon has said so, a
# token.
serves_behind_nginx()
{
    local examples=./usr/share/doc/beltflow/examples/nginx name=beltflow.example.org token
    dpkg-deb --fsys-tarfile /*.deb >/tmp/package.tar
    tar -xOf /tmp/package.tar $examples/beltflowd.conf >>/etc/beltflow/beltflow.conf
    systemctl restart beltflow 2>/dev/null && fail "without a token the daemon starts behind a proxy"
    [[ "$(property ActiveState) $(property ExecMainStatus)" == "failed 2" ]] || fail "systemd starts what cannot start"
    logged "token add NAME" || fail "the log does not say what to do"
    token=$(beltflowd token add alice 2>/dev/null)
    systemctl start beltflow

    mkdir -p /etc/ssl/beltflow /etc/nginx /var/lib/nginx
    tar -xOf /tmp/package.tar $examples/beltflow.conf >/etc/nginx/beltflow.conf
    [[ -e /proc/net/if_inet6 ]] || sed -i '/listen \[::\]/d' /etc/nginx/beltflow.conf
    openssl req -x509 -newkey rsa:2048 -nodes -subj /CN=$name -addext subjectAltName=DNS:$name \
        -keyout /etc/ssl/beltflow/privkey.pem -out /etc/ssl/beltflow/fullchain.pem 2>/tmp/openssl || fail "$(cat /tmp/openssl)"
    echo "events {} http { access_log off; include /etc/nginx/beltflow.conf; }" >/tmp/nginx.conf
    PATH=$PATH:/usr/sbin nginx -e stderr -g "user nobody nogroup; pid /run/nginx.pid;" -c /tmp/nginx.conf

    base=https://$name
    local user=(--resolve "$name:443:127.0.0.1" --cacert /etc/ssl/beltflow/fullchain.pem)
    [[ $(curl -sS -o /tmp/answer -w '%{http_code}' "${user[@]}" $base/v1/runs) == 401 ]] || fail "strangers are let in"
    user+=(-H "Authorization: Bearer $token")
    sed -i 's/200000/1/' /tmp/run.json
    run=$(ask /v1/runs "${user[@]}" -H 'Content-Type: application/json' --data-binary @/tmp/run.json | member id)
    ask "/v1/runs/$run/events" -N "${user[@]}" | grep '"status": *"succeeded"' >/dev/null || fail "no end of a run by nginx"
    sed -i 's/[123]00000/1/g' /tmp/study.json
    study=$(ask /v1/studies "${user[@]}" -H 'Content-Type: application/json' --data-binary @/tmp/study.json | member id)
    ask "/v1/studies/$study/events" -N "${user[@]}" | grep '"status": *"succeeded"' >/dev/null || fail "no end of a study by nginx"
}

if [[ ${1:-} == --try ]]; then
    trap 'systemctl exit $?' EXIT
    for step in starts_confined solves survives_a_kill drains copies serves_behind_nginx; do
        $step
        echo "unit: $step"
    done
    exit 0
fi

# in_groups COMMAND...: where all control groups are folders.
in_groups()
{
    # shellcheck disable=SC2016
    unshare --mount bash -euc 'mount -t cgroup2 none /mnt && cd /mnt && "$@"' - "$@"
}

deb=$(realpath "${1:?usage: unit.sh BELTFLOW.deb}")
export BELTFLOW_GROUP=beltflow-unit.$$
if ! in_groups mkdir "$BELTFLOW_GROUP"; then
    echo "unit: skipped, no control groups of version 2"
    exit 77
fi
trap 'in_groups find "$BELTFLOW_GROUP" -depth -type d -exec rmdir {} +' EXIT
"$(dirname "$0")/view.sh" "$0" "$deb"
