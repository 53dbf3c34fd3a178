#!/usr/bin/env bash
# A Slurm of this one machine, without systemd, cgroups and accounting, below the folder $1: cluster.sh DIR up|down.
# Needs root. Its daemons are ended by the ids that they left, and nothing else is touched.
set -eu
dir=$1 host=$(hostname -s) cpus=2
# Ports that other clusters on this machine do not have: from this folder's name.
port=$((20000 + $(echo "$dir" | cksum | cut -d' ' -f1) % 20000))
export SLURM_CONF=$dir/slurm.conf

configure() {
    mkdir -p "$dir"/{state,spool,log,munge}
    chmod 755 "$dir" "$dir/munge"
    dd if=/dev/urandom of="$dir/munge/key" bs=1 count=1024 status=none
    chmod 600 "$dir/munge/key"
    local node="CPUs=$cpus Boards=1 SocketsPerBoard=1 CoresPerSocket=$cpus ThreadsPerCore=1 RealMemory=500"
    local partition="Nodes=$host MaxTime=60 OverSubscribe=NO State=UP"
    cat >"$SLURM_CONF" <<CONF
ClusterName=hifdmtest
SlurmctldHost=$host(127.0.0.1)
SlurmUser=root
AuthType=auth/munge
AuthInfo=socket=$dir/munge/sock
CredType=cred/munge
SlurmctldPort=$port
SlurmdPort=$((port + 1))
StateSaveLocation=$dir/state
SlurmdSpoolDir=$dir/spool
SlurmctldPidFile=$dir/slurmctld.pid
SlurmdPidFile=$dir/slurmd.pid
SlurmctldLogFile=$dir/log/slurmctld.log
SlurmdLogFile=$dir/log/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
MpiDefault=none
SwitchType=switch/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerParameters=sched_interval=1,sched_min_interval=0,bf_interval=1
PreemptType=preempt/partition_prio
PreemptMode=REQUEUE
JobRequeue=1
KillWait=5
MinJobAge=300
ReturnToService=2
SlurmctldParameters=preempt_send_user_signal
NodeName=$host NodeAddr=127.0.0.1 $node State=UNKNOWN
PartitionName=low $partition Default=YES PriorityTier=1 PreemptMode=REQUEUE GraceTime=10
PartitionName=high $partition Default=NO PriorityTier=10 PreemptMode=OFF
CONF
}

up() {
    configure
    # --force: munged mistrusts folders below group-writable ones, such as that for temporary files
    munged --force --num-threads=2 --key-file="$dir/munge/key" --socket="$dir/munge/sock" \
        --pid-file="$dir/munge/pid" --log-file="$dir/log/munged.log" --seed-file="$dir/munge/seed"
    slurmctld -f "$SLURM_CONF"
    # CPUs are slots here and not cores, so a machine with fewer cores than the test asks for runs it as well.
    slurmd -f "$SLURM_CONF" -N "$host"
    for _ in $(seq 300); do
        case $(sinfo -h -n "$host" -o %T 2>/dev/null | head -n 1) in idle | mixed | allocated) return 0 ;; esac
        sleep 0.1
    done
    echo "Slurm did not come up; the ends of its logs:" >&2
    tail -n 5 "$dir"/log/*.log >&2
    return 1
}

down() {
    [ ! -s "$dir/slurmctld.pid" ] || timeout 10 scancel --user="$(id -un)" 2>/dev/null || true
    for file in slurmd.pid slurmctld.pid munge/pid; do
        [ -s "$dir/$file" ] || continue
        pid=$(cat "$dir/$file")
        kill "$pid" 2>/dev/null || continue
        for _ in $(seq 100); do kill -0 "$pid" 2>/dev/null || break; sleep 0.1; done
        kill -9 "$pid" 2>/dev/null || true
    done
}

"$2"
