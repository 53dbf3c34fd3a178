#!/usr/bin/env bash
# run.sh FOLDER [NAME...]: runs the harnesses FOLDER/fuzz_NAME, all when none is named, each over its corpus and what
# the fuzzer makes of it. `make fuzz` builds them and calls this.
#   FUZZ_SECONDS=60  for each harness      FUZZ_RUNS=N  as many inputs instead, however long they take
#   FUZZ_SEED=N      of the random numbers; another one each time when it is not given
#   FUZZ_JOBS=2      harnesses at a time
# Inputs that found something stay in FOLDER/found, and the command that repeats each is printed; exit status 1. What
# was learnt stays in FOLDER/corpus, where the next run goes on.
set -eu
cd "$(dirname "$0")/../.."
folder=$1
shift
[ $# != 0 ] || set -- $(ls tests/fuzz/corpus)
seed=${FUZZ_SEED:-$(date +%s)}
limit="-max_total_time=${FUZZ_SECONDS:-60}"
[ -z "${FUZZ_RUNS:-}" ] || limit="-runs=$FUZZ_RUNS"

# HDF5 and OpenMP keep what they allocated until the program ends; leaks are looked for after each input, and what is
# still reachable is none.
export ASAN_OPTIONS=detect_leaks=1:detect_stack_use_after_return=1:quarantine_size_mb=16:malloc_context_size=8
export UBSAN_OPTIONS=print_stacktrace=1 OMP_NUM_THREADS=1 OMP_WAIT_POLICY=passive
TMPDIR=$(mktemp -d "$([ -d /dev/shm ] && echo /dev/shm || echo "${TMPDIR:-/tmp}")/hifdm-fuzz-XXXXXX")
export TMPDIR
trap 'rm -rf "$TMPDIR"' EXIT
trap 'exit 130' INT TERM

mkdir -p "$folder/found" "$folder/log"
rm -f "$folder"/log/*.failed
# Keys and words of a case file, so that the fuzzer need not find them letter by letter.
"$folder/hifdm" schema | grep -oE '[A-Za-z_0-9]+' | sort -u | sed 's/.*/"&"/' >"$folder/yaml.dict"

# NAME: exit status 0 when nothing was found
fuzz() {
    local name=$1 log=$folder/log/$1.log words=()
    case $name in case | study) words=("-dict=$folder/yaml.dict") ;; esac
    mkdir -p "$folder/corpus/$name"
    # 4 kB: several times the longest key, row or record. An input that takes 20 s is a finding, and so is one that
    # asks for 400 MB at once.
    "$folder/fuzz_$name" -seed="$seed" "$limit" -max_len=4096 -timeout=20 -malloc_limit_mb=400 -rss_limit_mb=2000 \
        -print_final_stats=1 -artifact_prefix="$folder/found/$name-" "${words[@]}" \
        "$folder/corpus/$name" "tests/fuzz/corpus/$name" >"$log" 2>&1 </dev/null || touch "$folder/log/$name.failed"
}

say() {
    local name=$1 log=$folder/log/$1.log
    if [ -e "$folder/log/$name.failed" ]; then
        echo "$name: FOUND SOMETHING, seed $seed; $log ends with"
        grep -nE 'ERROR|runtime error|does not hold|SUMMARY|libFuzzer: ' "$log" | head -n 5 || true
        tail -n 3 "$log"
        sed -nE "s|.*Test unit written to (.*)|  repeat: $folder/fuzz_$name \1|p" "$log"
    else
        echo "$name: $(sed -nE 's/^stat::number_of_executed_units: *//p' "$log") inputs," \
            "$(sed -nE 's/^stat::average_exec_per_sec: *//p' "$log")/s, $(grep -oE 'cov: [0-9]+ ft: [0-9]+' "$log" |
            tail -n 1), seed $seed"
    fi
}

for name; do
    while [ "$(jobs -pr | wc -l)" -ge "${FUZZ_JOBS:-2}" ]; do wait -n || true; done
    fuzz "$name" &
done
wait
for name; do say "$name"; done
! ls "$folder"/log/*.failed >/dev/null 2>&1
