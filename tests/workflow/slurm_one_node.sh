#!/usr/bin/env bash
# A throw-away Slurm of one node on this machine, for tests: no systemd, no control groups, no accounting.
# Needs root and the Debian packages slurmctld, slurmd, slurm-client and munge.
# Usage: slurm_one_node.sh start|stop FOLDER [CPUS]
set -euo pipefail
action=$1
folder=$(realpath -m "$2")
cpus=${3:-$(nproc)}
node=$(hostname -s)
# Job steps do not inherit SLURM_CONF and look here.
installed=/etc/slurm/slurm.conf

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

start() {
    if [ -e "$installed" ]; then
        echo "$installed exists: this machine belongs to a cluster, or another test is running (stop it first)" >&2
        exit 1
    fi
    mkdir -p "$folder"/{munge,state,spool}
    chmod 755 "$folder" "$folder/munge"
    head -c 128 /dev/urandom >"$folder/munge/key"
    chmod 400 "$folder/munge/key"
    write_configuration
    mkdir -p "$(dirname "$installed")"
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
    scancel --user="$(id -un)" 2>/dev/null || true
    # Without the daemons nobody would end the jobs' processes.
    for _ in $(seq 100); do
        if [ -z "$(squeue --noheader 2>/dev/null)" ]; then break; fi
        sleep 0.1
    done
    for name in slurmd.pid slurmctld.pid munge/pid; do
        if [ -f "$folder/$name" ]; then kill "$(cat "$folder/$name")" 2>/dev/null || true; fi
    done
    if [ "$(readlink "$installed" 2>/dev/null)" = "$folder/slurm.conf" ]; then rm "$installed"; fi
}

case $action in
start) start ;;
stop) stop ;;
*) echo "usage: $0 start|stop FOLDER [CPUS]" >&2 && exit 2 ;;
esac
