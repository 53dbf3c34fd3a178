#!/bin/bash
# The same without a cluster, or on several machines by ssh: GNU parallel in the place of Slurm.
#
#     tools/slurm/sweep-parallel.sh TASKS STUDY [options of hifdm sweep]
#
# JOBS tasks at a time (1), each with THREADS threads (all cores). Run it again after whatever went wrong: tasks that
# failed are run again (--resume-failed), and of their points only those that are missing.
# Several machines: PARALLEL='--sshloginfile nodes.txt --workdir .' in the environment.
set -eu
[ $# -ge 2 ] || { echo "usage: sweep-parallel.sh TASKS STUDY [options]" >&2; exit 2; }
tasks=$1 study=$2
shift 2
seq 0 $((tasks - 1)) | parallel --jobs "${JOBS:-1}" --joblog "$(basename "${study%.*}").joblog" --resume-failed \
    "${HIFDM:-hifdm}" sweep "$study" --task {} --tasks "$tasks" ${THREADS:+--threads "$THREADS"} "$@"
