#!/bin/bash
# Runs the tasks of a sweep with GNU parallel instead of Slurm, on this machine or on several machines by ssh:
#
#     tools/slurm/sweep-parallel.sh TASKS STUDY [options of hifdm sweep]
#
# It runs JOBS tasks at a time (default 1), each with THREADS threads (default: all cores). After a failure, or after
# the study has grown, run it again: it runs all tasks, and these run only missing points. The exit status is the number
# of failed tasks, at most 101 (a limit of GNU parallel). For several machines, set
# PARALLEL='--sshloginfile nodes.txt --workdir .' in the environment.
set -eu
[[ $# -ge 2 && $1 =~ ^[1-9][0-9]{0,5}$ ]] || {
    echo "usage: sweep-parallel.sh TASKS STUDY [options of hifdm sweep], TASKS from 1 to 999999" >&2
    exit 2
}
tasks=$1 study=$2 program=${HIFDM:-hifdm}
shift 2
case $program in -*) program=./$program ;; esac
case $study in -*) study=./$study ;; esac

# GNU parallel starts a shell. It quotes the value of {}, but not the command around it, nor a word at its beginning.
# It also replaces {} and {= perl =} in that command. So all words of a task are passed as values, after exec.
words=("$program" sweep "$study" --tasks "$tasks" ${THREADS:+--threads "$THREADS"} "$@" --task)
for ((task = 0; task < tasks; task++)); do
    printf '%s\0' "${words[@]}" "$task"
done | parallel --jobs "${JOBS:-1}" --null --max-replace-args $((${#words[@]} + 1)) exec '{}'
