#!/bin/bash
# Runs the tasks without a cluster, or on several machines by ssh: GNU parallel takes the place of Slurm.
#
#     tools/slurm/sweep-parallel.sh TASKS STUDY [options of hifdm sweep]
#
# JOBS tasks run at a time (1), each with THREADS threads (all cores). Run the same command again after any failure, and
# after the study has grown: all tasks run, but only their missing points. The exit status is the number of tasks that
# failed, at most 101 (GNU parallel).
# For several machines set PARALLEL='--sshloginfile nodes.txt --workdir .' in the environment.
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
# at the beginning of the command, in which it also looks for {} and {= perl =}. So all words of a task come as values,
# after exec.
words=("$program" sweep "$study" --tasks "$tasks" ${THREADS:+--threads "$THREADS"} "$@" --task)
for ((task = 0; task < tasks; task++)); do
    printf '%s\0' "${words[@]}" "$task"
done | parallel --jobs "${JOBS:-1}" --null --max-replace-args $((${#words[@]} + 1)) exec '{}'
