#!/bin/sh
# A Slurm of one node with everything in one folder: one_node_slurm.sh start|stop FOLDER, as root. In /etc/slurm it
# leaves, until it stops, two links into that folder, since jobs see nothing of the variables of their submission; a
# machine that has a Slurm of its own is left alone.
# It has no control groups and no accounting database. A step's memory is looked at every second, and one that takes
# more than it asked for is killed.
set -eu
action=$1 folder=$2
conf=$folder/slurm.conf

end() {
    for daemon in slurmd slurmctld munged; do
        if [ -s "$folder/$daemon.pid" ]; then kill "$(cat "$folder/$daemon.pid")" 2>/dev/null || true; fi
    done
    for name in slurm.conf cgroup.conf; do
        if [ "$(readlink /etc/slurm/$name)" = "$folder/$name" ]; then rm "/etc/slurm/$name"; fi
    done
}

if [ "$action" = stop ]; then
    scancel --state=RUNNING --state=PENDING --quiet 2>/dev/null || true
    end
    exit
fi

if [ -e /etc/slurm/slurm.conf ]; then
    echo "this machine has a Slurm of its own: /etc/slurm/slurm.conf" >&2
    exit 1
fi
mkdir -p /etc/slurm "$folder/state" "$folder/spool"
# The daemon of munge asks that no one else may write above its socket.
chmod 755 "$folder"
node=$(hostname -s)
memory=$(awk '/MemTotal/ {print int($2 / 1024 * 0.9)}' /proc/meminfo)
cat >"$conf" <<END
ClusterName=one
SlurmctldHost=$node(127.0.0.1)
SlurmctldPort=26817
SlurmdPort=26818
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket=$folder/munge.socket
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.pid
SlurmctldLogFile=$folder/slurmctld.log
SlurmdLogFile=$folder/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU_Memory
JobAcctGatherType=jobacct_gather/linux
JobAcctGatherFrequency=task=1
JobAcctGatherParams=OverMemoryKill
AccountingStorageType=accounting_storage/none
MinJobAge=600
ReturnToService=2
NodeName=$node NodeAddr=127.0.0.1 CPUs=$(nproc) RealMemory=$memory
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
END
echo "CgroupPlugin=cgroup/v1" >"$folder/cgroup.conf"
ln -s "$conf" "$folder/cgroup.conf" /etc/slurm
head -c 1024 /dev/urandom >"$folder/munge.key"
chmod 600 "$folder/munge.key"
munged --force --socket="$folder/munge.socket" --key-file="$folder/munge.key" --pid-file="$folder/munged.pid" \
    --seed-file="$folder/munge.seed" --log-file="$folder/munged.log"
slurmctld
slurmd
for _ in $(seq 60); do
    if sinfo --noheader --format=%T 2>/dev/null | grep -q idle; then exit; fi
    sleep 0.5
done
echo "the node did not come up; see $folder/slurmctld.log and $folder/slurmd.log" >&2
end
exit 1
