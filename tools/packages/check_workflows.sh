#!/usr/bin/env bash
# check_workflows.sh PROGRAM FOLDER: tests the rules for Snakemake with Snakemake itself, in FOLDER. The table must be
# that of hifdm sweep, finished work must not be repeated, and a study that grew must run only its new points.
set -eu
program=$(realpath "$1") folder=$2 rules=$(realpath "$(dirname "$0")")/Snakefile
fail() { echo "check_workflows: $*" >&2; exit 1; }
command -v snakemake >/dev/null || fail "no snakemake here: apt-get install snakemake"

rm -rf "$folder"
mkdir -p "$folder"
cd "$folder"
"$program" new dish --paraboloid >/dev/null
cat >a\ study.yaml <<'YAML'
base: dish.yaml
sweep: {form.pretension_N: [5, 10, 20, 40]}
YAML
run() {
    snakemake -s "$rules" --cores 2 --quiet all --config studies="['a study.yaml']" program="$program" >log 2>&1 ||
        { cat log; fail "snakemake failed"; }
}
count() { cat "results/a study.d"/*.tsv | grep -c "$(printf '\tok\t')"; }

run
"$program" sweep "a study.yaml" --dir plain.d --quiet
"$program" merge "a study.yaml" --dir plain.d -o plain.h5 --quiet
"$program" diff "results/a study.h5" plain.h5 >/dev/null || fail "another table than that of hifdm sweep"
[ -s "results/a study.html" ] || fail "no report"
before=$(stat -c %Y.%y "results/a study.h5")
run
[ "$before" = "$(stat -c %Y.%y "results/a study.h5")" ] || fail "what is done is done again"
[ "$(count)" = 4 ] || fail "not every point was run once"
sed -i 's/, 40\]/, 40, 80]/' "a study.yaml"
run
[ "$(count)" = 5 ] || fail "a point more is not one more run"
sed -i 's/pretension_N: 10 /pretension_N: 11 /' dish.yaml
run
[ "$(count)" = 10 ] || fail "another base case is not all points anew"

# Two studies of the same name would write the same table.
mkdir other
cp "a study.yaml" other
if snakemake -s "$rules" --cores 2 --config studies="['a study.yaml', 'other/a study.yaml']" \
    program="$program" >log 2>&1; then fail "two studies of one name"; fi
grep -q "would both write" log || { cat log; fail "two studies of one name are not told"; }

# One iteration is too few, so that point fails, but the job does not.
"$program" new strips --cylinder >/dev/null
printf '%s\n' 'base: strips.yaml' 'sweep: {form.method: [hifdm], form.max_iterations: [1, 20000]}' >failing.yaml
sed -i '/^optimize:/,$d' strips.yaml
snakemake -s "$rules" --cores 2 --quiet all --config studies="['failing.yaml']" program="$program" results=other \
    >log 2>&1 || { cat log; fail "a failed point fails the job"; }
"$program" status failing.yaml --dir other/failing.d | grep -q '^  failed *1$' || fail "no point failed"
echo "Snakemake $(snakemake --version): a study is one job, done once, and goes on with new points alone"
