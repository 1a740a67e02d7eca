#!/bin/sh
# One-node Slurm on the loopback, everything of it in one folder; nothing of the system's own Slurm is touched.
#
#   slurm_node.sh start FOLDER    prints the SLURM_CONF that sbatch and squeue want
#   slurm_node.sh stop FOLDER
#
# Exit code 77: Slurm or munge is not installed, or the node does not come up here.
set -eu

verb=$1
folder=$(CDPATH='' cd -- "$2" && pwd)

stop() {
  for name in slurmd slurmctld munged; do
    [ -f "$folder/$name.pid" ] || continue
    pid=$(cat "$folder/$name.pid")
    kill "$pid" 2> /dev/null || true
    while kill -0 "$pid" 2> /dev/null; do sleep 0.1; done
    rm -f "$folder/$name.pid"
  done
}

if [ "$verb" = stop ]; then
  stop
  exit 0
fi

export PATH="$PATH:/usr/sbin:/sbin"
for program in munged slurmctld slurmd sbatch scontrol; do
  if ! command -v "$program" > /dev/null; then
    echo "$program is not installed (Debian: slurmctld slurmd slurm-client munge)" >&2
    exit 77
  fi
done

# Ports that nobody else is likely to have: from the process's id.
port=$((20000 + $$ % 20000))
host=$(hostname -s)
mkdir -p "$folder/state" "$folder/spool"
(umask 077 && dd if=/dev/urandom of="$folder/munge.key" bs=128 count=1 2> /dev/null)
cat > "$folder/slurm.conf" << CONF
ClusterName=loopback
SlurmctldHost=$host(127.0.0.1)
SlurmUser=$(id -un)
SlurmdUser=$(id -un)
AuthType=auth/munge
AuthInfo=socket=$folder/munge.socket
CredType=cred/munge
SlurmctldPort=$port
SlurmdPort=$((port + 1))
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
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerParameters=sched_interval=1,batch_sched_delay=0,default_queue_depth=100
ReturnToService=2
KillWait=2
MpiDefault=none
SwitchType=switch/none
NodeName=$host NodeAddr=127.0.0.1 CPUs=$(nproc) State=UNKNOWN
PartitionName=all Nodes=$host Default=YES MaxTime=INFINITE State=UP
CONF
chmod 644 "$folder/slurm.conf"
export SLURM_CONF="$folder/slurm.conf"

munged --force --key-file="$folder/munge.key" --socket="$folder/munge.socket" --pid-file="$folder/munged.pid" \
  --log-file="$folder/munged.log" --seed-file="$folder/munge.seed" --num-threads=1 > "$folder/munged.out" 2>&1 || {
  cat "$folder/munged.out" >&2
  exit 77
}
slurmctld -c > "$folder/slurmctld.out" 2>&1 || { cat "$folder/slurmctld.out" >&2; stop; exit 77; }
slurmd -N "$host" > "$folder/slurmd.out" 2>&1 || { cat "$folder/slurmd.out" >&2; stop; exit 77; }
tries=0
until sinfo -h -o %T 2> /dev/null | grep -qx idle; do
  tries=$((tries + 1))
  if [ "$tries" -gt 100 ]; then
    echo "the node does not become idle: $(sinfo -h -o '%T %E' 2>&1)" >&2
    tail -n 5 "$folder/slurmd.log" "$folder/slurmctld.log" >&2
    stop
    exit 77
  fi
  sleep 0.1
done
echo "$SLURM_CONF"
