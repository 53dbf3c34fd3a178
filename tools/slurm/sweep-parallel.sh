#!/bin/bash
# The same without a cluster, or on several machines by ssh: GNU parallel in the place of Slurm.
#
#     tools/slurm/sweep-parallel.sh TASKS STUDY [options of hifdm sweep]
#
# JOBS tasks at a time (1), each with THREADS threads (all cores). Run it again after whatever went wrong, and after the
# study has grown: all tasks are run, and of their points those that are missing. Ends with the number of tasks that
# failed, at most 101 (GNU parallel).
# Several machines: PARALLEL='--sshloginfile nodes.txt --workdir .' in the environment.
set -eu
[[ $# -ge 2 && $1 =~ ^[1-9][0-9]{0,5}$ ]] || {
    echo "usage: sweep-parallel.sh TASKS STUDY [options of hifdm sweep], TASKS from 1 to 999999" >&2
    exit 2
}
tasks=$1 study=$2 program=${HIFDM:-hifdm}
shift 2
case $program in -*) program=./$program ;; esac
case $study in -*) study=./$study ;; esac

# GNU parallel starts a shell. It quotes what it puts in the place of {}, but neither the command around it nor a word
# at its beginning, and looks for {} and {= perl =} in that command; so all words of a task come as values, behind exec.
words=("$program" sweep "$study" --tasks "$tasks" ${THREADS:+--threads "$THREADS"} "$@" --task)
for ((task = 0; task < tasks; task++)); do
    printf '%s\0' "${words[@]}" "$task"
done | parallel --jobs "${JOBS:-1}" --null --max-replace-args $((${#words[@]} + 1)) exec '{}'
