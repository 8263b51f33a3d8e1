#!/usr/bin/env bash
# A throw-away Slurm of one node on this machine, for tests: no systemd, no control groups, no accounting.
# Needs root and the Debian packages slurmctld, slurmd, slurm-client and munge.
# Usage: slurm_one_node.sh start|stop FOLDER [CPUS]
#        slurm_one_node.sh clear: take away one whose starter has ended without stopping it; fails if another cluster is here
set -euo pipefail
action=${1:-}
folder=$(realpath -m "${2:-.}")
cpus=${3:-$(nproc)}
node=$(hostname -s)
# Job steps do not inherit SLURM_CONF and look here.
installed=/etc/slurm/slurm.conf
# Whose cluster that is: its folder, the process that started it, and when that process began.
owner=/etc/slurm/walklab_one_node

write_configuration() {
    local memory_mb
    memory_mb=$(awk '/MemTotal/ {print int($2 / 1024 * 0.8)}' /proc/meminfo)
    cat >"$folder/slurm.conf" <<CONF
ClusterName=onenode
SlurmctldHost=$node(127.0.0.1)
SlurmctldPort=17817
SlurmdPort=17818
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
CredType=cred/munge
AuthInfo=socket=$folder/munge/socket
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.pid
SlurmctldLogFile=$folder/slurmctld.log
SlurmdLogFile=$folder/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SwitchType=switch/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core_Memory
SchedulerParameters=sched_interval=1,bf_interval=1,sched_min_interval=0,batch_sched_delay=0
ReturnToService=2
KillWait=2
MinJobAge=600
MaxArraySize=1001
# The node may promise more processors than the machine has.
SlurmdParameters=config_overrides
NodeName=$node NodeAddr=127.0.0.1 CPUs=$cpus RealMemory=$memory_mb State=UNKNOWN
PartitionName=main Nodes=$node Default=YES MaxTime=02:00:00 DefMemPerCPU=500 State=UP
CONF
}

# When a process began (ticks since the machine did); nothing if it has ended.
began() {
    sed 's/.*) //' "/proc/$1/stat" 2>/dev/null | cut -d ' ' -f 20
}

# A test that was killed leaves daemons and links behind, which would stop every later one.
clear_abandoned() {
    if [ ! -e "$installed" ] && [ ! -L "$installed" ]; then return; fi
    local left="" pid="" since="" daemon
    if [ -f "$owner" ]; then { read -r left && read -r pid since; } <"$owner"; fi
    if [ -z "$left" ] || [ "$(readlink "$installed")" != "$left/slurm.conf" ]; then
        echo "$installed exists: this machine has a cluster already" >&2
        exit 1
    fi
    if [ "$(began "$pid")" = "$since" ]; then
        echo "$installed exists: the cluster of process $pid is running (slurm_one_node.sh stop $left)" >&2
        exit 1
    fi
    echo "taking away the cluster in $left, whose starter has ended" >&2
    folder=$left stop
    # Its folder, and with it the numbers of its daemons, may be gone.
    for daemon in /proc/[0-9]*; do
        case "$(readlink "$daemon/exe" 2>/dev/null)" in
        */slurmd* | */slurmctld* | */munged)
            if tr '\0' '\n' <"$daemon/cmdline" | grep --quiet --fixed-strings "$left/"; then kill "${daemon#/proc/}" 2>/dev/null || true; fi
            ;;
        esac
    done
}

start() {
    clear_abandoned
    mkdir -p "$folder"/{munge,state,spool}
    chmod 755 "$folder" "$folder/munge"
    head -c 128 /dev/urandom >"$folder/munge/key"
    chmod 400 "$folder/munge/key"
    write_configuration
    mkdir -p "$(dirname "$installed")"
    printf '%s\n' "$folder" "$PPID $(began "$PPID")" >"$owner"
    ln -s "$folder/slurm.conf" "$installed"
    # --force: the folder may lie below one that everybody can write to, as /tmp.
    munged --force --key-file="$folder/munge/key" --socket="$folder/munge/socket" --pid-file="$folder/munge/pid" \
        --log-file="$folder/munge/log" --seed-file="$folder/munge/seed" 2>"$folder/munge/warnings"
    slurmctld -f "$folder/slurm.conf"
    slurmd -f "$folder/slurm.conf"
    for _ in $(seq 300); do
        if [ "$(sinfo --noheader --format=%t 2>/dev/null)" = idle ]; then return; fi
        sleep 0.1
    done
    echo "the node did not become idle; see $folder/slurmctld.log and slurmd.log" >&2
    stop
    exit 1
}

stop() {
    if [ -f "$folder/slurm.conf" ]; then # else these wait for a controller that they cannot find
        scancel --user="$(id -un)" 2>/dev/null || true
        # Without the daemons nobody would end the jobs' processes.
        for _ in $(seq 100); do
            if [ -z "$(squeue --noheader 2>/dev/null)" ]; then break; fi
            sleep 0.1
        done
    fi
    for name in slurmd.pid slurmctld.pid munge/pid; do
        if [ -f "$folder/$name" ]; then kill "$(cat "$folder/$name")" 2>/dev/null || true; fi
    done
    if [ "$(readlink "$installed" 2>/dev/null)" = "$folder/slurm.conf" ]; then rm -f "$installed" "$owner"; fi
}

case $action in
start) start ;;
stop) stop ;;
clear) clear_abandoned ;;
*) echo "usage: $0 start|stop FOLDER [CPUS], or clear" >&2 && exit 2 ;;
esac
