#!/usr/bin/env bash
# Tests the job array with a real Slurm on this machine: an array is submitted, one task is killed with -9 and
# requeued, one is preempted, one is cancelled, and in the end the merge equals that of the same sweep run at once, data
# set by data set. Then the same with GNU parallel, and both with names that a shell would run. Needs root, slurm-wlm,
# munge and parallel (tools/setup.sh --ci).
set -eu
cd "$(dirname "$0")/../.."
hifdm=$(realpath "${HIFDM:-build/hifdm}") source=$PWD python=${PYTHON:-/usr/bin/python3}

for program in sbatch slurmctld slurmd munged parallel; do
    command -v $program >/dev/null ||
        { echo "cannot test job arrays: no $program here; 'tools/setup.sh --ci' installs slurm-wlm, munge, parallel" >&2
          exit 1; }
done
if [ "$(id -u)" != 0 ]; then
    sudo -n true 2>/dev/null || { echo "cannot test job arrays: Slurm's daemons need root, or sudo" >&2; exit 1; }
    exec sudo -n HIFDM="$hifdm" PYTHON="$python" "$0"
fi

work=$(mktemp -d "${TMPDIR:-/tmp}/hifdm-slurm-XXXXXX")
clean_up() {
    local code=$?
    [ $code = 0 ] || tail -n 8 "$work"/*.log 2>/dev/null >&2 || true
    "$source/tests/slurm/cluster.sh" "$work/cluster" down || true
    rm -rf "$work"
    exit $code
}
trap clean_up EXIT
trap 'exit 130' INT TERM
export SLURM_CONF=$work/cluster/slurm.conf OMP_WAIT_POLICY=passive

fail() { echo "FAILED: $*" >&2; exit 1; }
# within SECONDS COMMAND...: until it succeeds
within() {
    local end=$((SECONDS + $1)); shift
    until "$@"; do
        [ $SECONDS -lt $end ] || fail "waited too long for: $*"
        sleep 0.1
    done
}
count() { "$hifdm" status study.yaml --dir "$1" --json |
    "$python" -c 'import json,sys; print(json.load(sys.stdin)[sys.argv[1]])' "$2"; }
is_state() { scontrol -o show job "$1" 2>/dev/null | grep -q "JobState=$2"; }
is_gone() { [ -z "$(squeue -h -j "$1" 2>/dev/null)" ]; }
was_told_to_stop() { cat hifdm-sweep-*.log | grep -q 'the sweep was interrupted'; }
is_there() { [ -s "$1" ]; }

# ---- The study: eight points of about a second -----------------------------------------------------------------------
cd "$work"
cp "$source/configs/straight-edges.yaml" base.yaml
cat >study.yaml <<'YAML'
base: base.yaml
sweep:
  form.pretension_N: [6, 8, 10, 12]
  optimize.seed: [1, 2]
  optimize.population: [50]
  optimize.solver: [newton]
  optimize.generations: [300]
  optimize.stagnation_generations: [300]
  optimize.refine_steps: [2]
YAML
# Records which process works for which task.
cat >hifdm-task <<SH
#!/bin/sh
echo \$\$ >"$work/pid.\${SLURM_ARRAY_TASK_ID:-\$PARALLEL_SEQ}"
exec "$hifdm" "\$@"
SH
chmod +x hifdm-task
export HIFDM=$work/hifdm-task

"$hifdm" sweep study.yaml --dir local.d --quiet
"$hifdm" merge study.yaml --dir local.d -o local.h5
[ "$(count local.d done)" = 8 ] || fail "the local sweep is not complete"

# Everything equal to the local sweep: the tables, and the run of every point behind its link.
equals_local() {
    "$hifdm" merge study.yaml --dir "$1.d" -o "$1.h5"
    "$python" "$source/tests/cli/expect.py" local.h5 "$1.h5" -- "differing(a, b) == []" "len(contents(a)) > 40" \
        "len(a['runs']) == len(b['runs']) == 8" \
        "[id for id in a['runs'] if differing(a['runs'][id], b['runs'][id])] == []"
}

# ---- The array -------------------------------------------------------------------------------------------------------
"$source/tests/slurm/cluster.sh" "$work/cluster" up
submit() { sbatch --parsable --array=0-3 --cpus-per-task=1 --time=10 "$source/tools/slurm/sweep.sbatch" \
    study.yaml --dir array.d; }
is_working() { [ -s pid.0 ] && [ -d array.d ] && [ "$(count array.d running)" -gt 0 ]; }

job=$(submit)
echo "array $job of 4 tasks"
within 60 is_working
kill -9 "$(cat pid.0)"
within 60 is_state "${job}_0" FAILED
echo "task 0 killed with -9: $(count array.d done) points done so far"
scontrol requeue "${job}_0"
scontrol update jobid="${job}_0" starttime=now
scancel "${job}_3"
echo "task 0 requeued, task 3 cancelled"

# A job of a higher partition takes the whole node for a moment: the tasks that run are told to stop, and requeued.
within 60 is_there pid.1
high=$(sbatch --parsable --partition=high --cpus-per-task=2 --output=high.log --wrap='sleep 1')
within 60 is_gone "$high"
within 60 was_told_to_stop
echo "preempted: $(cat hifdm-sweep-*.log | grep -c 'the sweep was interrupted') tasks were told to stop and did"
for task in 0 1 2; do # after preemption Slurm waits two minutes as well
    scontrol update jobid="${job}_$task" starttime=now 2>/dev/null || true
done
within 180 is_gone "$job"
missing=$(count array.d missing)
restarts=$(grep -l 'restart [1-9]' hifdm-sweep-*.log | wc -l)
echo "array over: $restarts tasks were started more than once, $missing points missing, $(count array.d failed) failed"
[ "$restarts" -ge 2 ] || fail "task 0 and a preempted one should have been started again"
[ "$missing" -gt 0 ] || fail "the cancelled task left nothing to do: this test tests nothing"

job=$(submit)
within 180 is_gone "$job"
[ "$(count array.d done)" = 8 ] || { "$hifdm" status study.yaml --dir array.d; fail "points are missing"; }
equals_local array || fail "the array's results differ from the local sweep's"
echo "resubmitted: all 8 points done, equal to the local sweep"

# ---- GNU parallel ----------------------------------------------------------------------------------------------------
rm -f pid.*
export JOBS=2 THREADS=1
"$source/tools/slurm/sweep-parallel.sh" 3 study.yaml --dir twin.d --quiet >parallel.log 2>&1 &
twin=$!
within 60 is_there pid.2
kill -9 "$(cat pid.2)"
wait $twin && fail "GNU parallel did not notice that a task was killed"
"$source/tools/slurm/sweep-parallel.sh" 3 study.yaml --dir twin.d --quiet >parallel.log 2>&1 ||
    fail "GNU parallel did not finish the second time"
equals_local twin || fail "GNU parallel's results differ from the local sweep's"
echo "GNU parallel: one task killed, run again, equal to the local sweep"

# A study of the same name elsewhere, and a point whose file is gone: all tasks are run again, whoever ran them before.
rm "$(find twin.d -name '*.h5' | sort | head -n 1)"
"$source/tools/slurm/sweep-parallel.sh" 3 study.yaml --dir twin.d --quiet >parallel.log 2>&1 && equals_local twin ||
    fail "GNU parallel did not make the point whose file was gone: $(cat parallel.log)"
"$source/tools/slurm/sweep-parallel.sh" 3 study.yaml --dir other.d --quiet >parallel.log 2>&1 && equals_local other ||
    fail "GNU parallel did not sweep into another folder: $(cat parallel.log)"
for tasks in 0 -1 '' abc 1e3; do
    "$source/tools/slurm/sweep-parallel.sh" "$tasks" study.yaml --dir none.d >parallel.log 2>&1 && status=0 || status=$?
    [ $status = 2 ] && grep -q usage parallel.log || fail "sweep-parallel.sh with '$tasks' tasks: exit status $status"
done
echo "GNU parallel: a lost point, another folder, wrong numbers of tasks"

# ---- Names: of studies, folders and the program, that a shell or GNU parallel would run or take apart ----------------
names=('blanks  in it' 'semi;touch PWNED;colon' '$(touch PWNED)' '`touch PWNED`' "it's" 'say "it"' 'back\slash\\' \
    '-dash' '--dir' $'two\nlines' '{} {#} {1}' '{= system("touch PWNED"); =}' '&touch PWNED&' '|touch PWNED' \
    '*' '~' 'a=b' ':::')
export JOBS=1 THREADS=1 SBATCH_TIMELIMIT=10
unset SLURM_ARRAY_TASK_ID

# make_names FOLDER NAME: a study of two points and a program of this name, in a folder of this name
make_names() {
    mkdir -p "$1" && cd "$1"
    printf 'scene: {parabolic_cylinder: {aperture_m: 2, length_m: 3, focal_length_m: 2, modules: [2, 3], %s}}\n' \
        'cells_per_module: [2, 2], scallop: 0.1' >base.yaml
    printf 'base: base.yaml\nsweep: {form.pretension_N: [8, 12]}\n' >"./$2.yaml"
    ln -sf "$hifdm" "./$2"
}
# demand_names HOW NAME: both points are done in the folder that was asked for, and nothing else was run
demand_names() {
    "$hifdm" status "./$2.yaml" --dir "./$2.out" --json | grep -q '"done": 2' ||
        fail "$1: the points of a study named $(printf %q "$2") are not done"
    [ -z "$(find "$work" -name 'PWNED*')" ] || fail "$1: the name $(printf %q "$2") was run"
}
for i in "${!names[@]}"; do
    name=${names[i]}
    make_names "$work/twin.$i/$name" "$name"
    HIFDM="$PWD/$name" "$source/tools/slurm/sweep-parallel.sh" 2 "$name.yaml" --dir "./$name.out" --quiet \
        >twin.log 2>&1 || fail "GNU parallel, name $(printf %q "$name"): $(cat twin.log)"
    demand_names "GNU parallel" "$name"
done
jobs=()
for i in "${!names[@]}"; do
    name=${names[i]}
    make_names "$work/array.$i/$name" "$name"
    program=$PWD/$name
    cd "$work/array.$i" # Slurm itself cannot write the log of a job whose folder has a backslash in its name
    jobs+=("$(HIFDM=$program sbatch --parsable --array=0-1 --cpus-per-task=1 "$source/tools/slurm/sweep.sbatch" \
        "$name/$name.yaml" --dir "./$name/$name.out")")
done
for i in "${!names[@]}"; do
    within 120 is_gone "${jobs[i]}"
    cd "$work/array.$i/${names[i]}"
    demand_names Slurm "${names[i]}"
done
cd "$work"
echo "names: ${#names[@]} with GNU parallel and with Slurm, none was run"
