#!/usr/bin/env bash
# Checks the rules of the house that a program can check. Each finding is one line, file:line: text. Exit status 1 if
# there is any.
set -eu
export LC_ALL=C.UTF-8
cd "$(dirname "$0")/.."

# ---- Lists for the rules; change them here when the house changes ----------------------------------------------------
# may call malloc and related functions: set-up, never the hot path
heap_files="base/status base/arena base/text base/csv linalg/lapack net/scene net/generate_[a-z_]*
            net/cable_set net/scene_arrays net/facet_import case/config_load_cases net/scene_import net/front_net
            net/model truss/truss truss/generate_[a-z_]* truss/truss_import truss/frame search/batch
            case/config case/study case/study_read store/hdf5 store/journal store/samples store/generations
            store/store_file store/store_internal store/store store/store_read store/store_resume store/compare
            store/store_look store/layout store/layout_truss store/layout_stage store/layout_front
            store/layout_tolerance store/renamed store/summary store/ledger store/merge
            run/problem run/problem_parts run/run run/stages_[a-z]* run/load_case_stage run/requirements_stage
            run/tolerance_stage run/take_point run/flat run/sweep out/merged out/merged_groups out/report_required
            app/options app/cmd_evaluate"
# may print (csv, json, summary: to a given stream)
print_files="base/csv base/json store/summary out/[a-z_]* app/cmd_[a-z_]* app/progress app/main"
openmp_files="search/parallel linalg/lapack"         # may mention OpenMP
# in addition to dot-files
top_level="Makefile README.md CHANGELOG.md CITATION.cff LICENSE src include configs tests results tools"
max_file=1000 max_function=80 long_function=60                        # lines; between the last two lint only warns

rooms="$(make -s print-LIB_ROOMS) $(make -s print-APP_ROOMS)"
page=$(make -s print-PAGE)                           # parts of the page of `report`

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
findings=$work/findings
report() { tee -a "$findings"; }
# Lists tracked and new files, so that lint finds faults before they are committed; in a tarball, all files.
files_under() {
    if [ -e .git ]; then
        git ls-files -co --exclude-standard -- "$@" | while read -r file; do [ ! -e "$file" ] || echo "$file"; done
    else
        find "$@" -type f
    fi | sort
}
source_files=$(files_under src include | grep '\.[ch]$' || true)
# Without files the tools below would read standard input.
[ -n "$source_files" ] || { echo "lint: no sources found (does git ls-files work here?)" >&2; exit 1; }
c_files=$(files_under src include tests | grep '\.[ch]$')
text_files=$(files_under src include tests tools configs .ci .github Makefile README.md CHANGELOG.md CITATION.cff |
    grep -E '\.(c|h|sh|py|awk|ya?ml|md|cff|html|css|js|mjs)$|^\.ci/|^Makefile$')

# ---- Rooms: what is in src/, and what each room may include ---------------------------------------------------------
# A module is src/ROOM/NAME.c with one header, src/ROOM/NAME.h or include/hifdm/NAME.h. X_part.c implements a part of X
# and may share its header.
files_under src include | while read -r file; do
    name=$(basename "${file%.[ch]}")
    room=$(basename "$(dirname "$file")")
    case $file in
    src/ARCHITECTURE.md | src/METHOD.md | src/manual/*.md | src/case/keys.md) ;;
    include/hifdm/hifdm.h | include/hifdm/api.h) ;; # without a source
    src/out/report/*)
        case " $page " in *" $file "*) ;; *) echo "$file:1: no part of the page (Makefile: PAGE)" ;; esac ;;
    src/*/*/*) echo "$file:1: rooms have no rooms" ;;
    src/*/*.c)
        case " $rooms " in *" $room "*) ;; *) echo "$file:1: its room is not listed in the Makefile" ;; esac
        [ ! -e "src/$room/$name.h" ] || [ ! -e "include/hifdm/$name.h" ] || echo "$file:1: module has two headers"
        header=$name
        while [ ! -e "src/$room/$header.h" ] && [ ! -e "include/hifdm/$header.h" ] && [[ $header == *_* ]]; do
            header=${header%_*}
        done
        [ -e "src/$room/$header.h" ] || [ -e "include/hifdm/$header.h" ] || [ "$file" = src/app/main.c ] ||
            echo "$file:1: module has no header"
        ;;
    src/*/*.h | include/hifdm/*.h)
        [ -n "$(ls src/*/"$name".c src/*/"$name"_*.c 2>/dev/null)" ] || echo "$file:1: header without a source" ;;
    *) echo "$file:1: not in a room" ;;
    esac
done | report

# src/ARCHITECTURE.md has the table of what each room may use. hifdm.h includes everything, so it is for programs.
for file in src/*/*.c; do echo "$(basename "${file%.c}") $(basename "$(dirname "$file")")"; done >"$work/room_of"
awk -v rooms="$rooms" '
    FILENAME == "src/ARCHITECTURE.md" {
        if (!match($0, /^\| `[a-z]+` \|/)) next
        split($0, cell, "|"); room = cell[2]; gsub(/[ `]/, "", room); may_use[room] = " " cell[4] " " room " "; next
    }
    FILENAME ~ /room_of$/ { room_of[$1] = $2; next }
    FNR == 1 {
        n = split(FILENAME, part, "/"); name = part[n]; sub(/\.[ch]$/, "", name)
        self = FILENAME ~ /^src/ ? part[2] : room_of[name]
        if (self == "") { head = name "_"; for (m in room_of) if (index(m, head) == 1) self = room_of[m] }
        if (name != "hifdm" && name != "api" && !(self in may_use))
            print FILENAME ":1: room `" self "` is not in src/ARCHITECTURE.md"
    }
    name != "hifdm" && /^[ \t]*#[ \t]*include[ \t]*("|<hifdm\/)/ {
        other = $0; sub(/^[^"<]*["<]/, "", other); sub(/[">].*/, "", other)
        module = ""
        if (other ~ /^hifdm\//) { module = other; gsub(/^hifdm\/|\.h$/, "", module); room = room_of[module] }
        else { room = other; sub(/\/.*/, "", room) }
        if (module != "api" && !index(may_use[self], " " room " "))
            print FILENAME ":" FNR ": room " self " may not use " other
    }' src/ARCHITECTURE.md "$work/room_of" $source_files | report

# ---- Sizes -----------------------------------------------------------------------------------------------------------
# A function is everything between a { and a } in column 0; its lines are those in between.
awk -v max_file=$max_file -v max=$max_function -v long=$long_function '
    function end_file() {
        if (lines > max_file) print file ":" lines ": " lines " lines in a file, more than " max_file
    }
    FNR == 1 { end_file(); file = FILENAME; name = "?" }
    { lines = FNR }
    /^[A-Za-z_].*\(/ { name = $0; sub(/\(.*/, "", name); sub(/.*[ *]/, "", name) }
    /^\{/ { start = FNR }
    /^\}/ && start {
        n = FNR - start - 1
        if (n > max) print FILENAME ":" start ": " n " lines in " name "(), more than " max
        else if (n > long) print FILENAME ":" start ": warning: " n " lines in " name "(), more than " long
        start = 0
    }
    END { end_file() }' $source_files >"$work/sizes"
grep -v ' warning: ' "$work/sizes" | report || true
grep ' warning: ' "$work/sizes" || true

# ---- Text ------------------------------------------------------------------------------------------------------------
# search PATTERN MESSAGE FILE... The brackets in the patterns below keep them from matching this file.
search() {
    local pattern=$1 message=$2
    shift 2
    grep -HnIE -e "$pattern" -- "$@" | sed -E "s|^([^:]*:[0-9]+):.*|\1: $message|" | report || true
}
search $'\t' 'tab' $(echo "$text_files" | grep -vx Makefile)
search '[[:blank:]]$' 'trailing blank' $text_files
search '^.{121}' 'more than 120 columns' $(echo "$text_files" | grep -v '\.md$')
search '\b(TOD[O]|FIXM[E]|XX[X])\b' 'unfinished: say it in an issue' $text_files
search '(^|[^[:alnum:]_.])/(wor[k]|hom[e]|roo[t]|User[s])/' 'path of one machine' $text_files

# A section or equation of the method in a comment must exist in src/METHOD.md: "METHOD section 7, M11".
grep -HnoE 'METHOD(\.md)? section [0-9]+|METHOD[^:]*\bM[0-9]+\b' -- $c_files | while IFS= read -r found; do
    place=$(echo "$found" | cut -d: -f1,2) words=$(echo "$found" | cut -d: -f3-)
    for n in $(echo "$words" | grep -oE 'section [0-9]+' | cut -d' ' -f2); do
        grep -q "^## $n\. " src/METHOD.md || echo "$place: src/METHOD.md has no section $n"
    done
    for n in $(echo "$words" | grep -oE '\bM[0-9]+\b'); do
        grep -q "($n)" src/METHOD.md || echo "$place: src/METHOD.md has no equation $n"
    done
done | report

# What the documents mention must exist: hf_... and HF_... in a source, files such as search/batch.c, targets of links.
# hf_module_verb, hf_noun and names with a part in capitals (hf_cmd_NAME) stand for several names.
documents="README.md src/ARCHITECTURE.md src/METHOD.md .github/CONTRIBUTING.md"
# The table of renames has names that no longer exist, and names to come.
documents="$documents $(files_under src/manual | grep -vx src/manual/renames.md | tr '\n' ' ')"
grep -ohE '\b(hf|HF)_[A-Za-z0-9_]+' $source_files | sort -u >"$work/names"
grep -HnoE '\b(hf|HF)_[A-Za-z0-9_]+\b' -- $documents | grep -vE ':(hf_module_verb|hf_noun|hf_.*[A-Z].*)$' |
    while IFS=: read -r file line name; do
        grep -qxF -- "$name" "$work/names" || echo "$file:$line: there is no $name"
    done | report
grep -HnoE '`([a-z0-9_]+/)*[a-z0-9_]+\.(c|h|py|sh)`' -- $documents | tr -d '`' | while IFS=: read -r file line name; do
    [ -n "$(ls -d "$name" "src/$name" "include/$name" src/*/"$name" include/hifdm/"$name" 2>/dev/null)" ] ||
        echo "$file:$line: there is no file $name"
done | report
grep -HnoE '\]\([^)#:]+[)#]' -- $documents | sed -E 's/\]\(([^)#]+)[)#]$/\1/' | while IFS=: read -r file line name; do
    [ -e "$(dirname "$file")/$name" ] || echo "$file:$line: a link to $name, which is not there"
done | report

# ---- Calls that only few modules may make ----------------------------------------------------------------------------
# The search is in the code without its comments and literals, as lines file:line:code.
awk -v sq="'" '
    FNR == 1 { comment = 0 }
    {
        rest = $0; code = ""
        while (rest != "") {
            if (comment) {
                if (!(end = index(rest, "*/"))) break
                rest = substr(rest, end + 2); comment = 0
            } else if (match(rest, "/\\*|//|\"|" sq)) {
                code = code substr(rest, 1, RSTART - 1)
                token = substr(rest, RSTART, RLENGTH); rest = substr(rest, RSTART + RLENGTH)
                if (token == "/*") comment = 1
                else if (token == "//") break
                else if (match(rest, "^([^\\\\" token "]|\\\\.)*" token)) rest = substr(rest, RLENGTH + 1)
            } else { code = code rest; break }
        }
        print FILENAME ":" FNR ":" code
    }' $source_files >"$work/code"

# only_in "ROOM/MODULE..." PATTERN MESSAGE
only_in() {
    grep -vE "^src/(${1// /|})\.[ch]:" "$work/code" | grep -E "^[^:]*:[0-9]+:.*($2)" |
        sed -E "s#^([^:]*:[0-9]+):.*#\1: $3 (allowed in: $1)#" | report || true
}
heap_files=$(echo $heap_files) print_files=$(echo $print_files)
only_in app/main '\bgsl_set_error_handler' 'setting the error handler of the whole program'
only_in "$heap_files" '\b(malloc|calloc|realloc|aligned_alloc|posix_memalign|strdup|strndup)[[:blank:]]*\(' 'heap call'
only_in "$print_files" '\b(v?f?printf|f?puts|f?putc|putchar|perror|exit|_Exit|abort)[[:blank:]]*\(' 'prints or exits'
file_calls='rename|renameat|link|linkat|mkstemp|mkdtemp|tmpfile|tempnam|creat|mkdir|truncate'
only_in base/file_out "\b($file_calls)[[:blank:]]*\(|\bO_(CREAT|TRUNC|TMPFILE)\b" 'makes or names a file by hand'
only_in store/hdf5 '\bH5Fcreate\b' 'HDF5 file that is not made by base/file_out'
only_in "base/text linalg/lapack" '\b(fopen|freopen)[[:blank:]]*\(' \
    'opens a file by fopen; files are made by base/file_out'
only_in "base/file_io base/file_out base/text out/report_page out/export" \
    '(^|[^>._[:alnum:]])(p?read|p?writev?|f(data)?sync|ftruncate|flock)[[:blank:]]*\(' 'a transfer by hand'
only_in "$openmp_files" '\bomp(\b|_)|\b_OPENMP\b' 'OpenMP'

# ---- Changelog -------------------------------------------------------------------------------------------------------
awk -v most=60 '
    function told() { if (n > most) print "CHANGELOG.md:" at ": a version has more than " most " lines" }
    /^## / { told(); n = 0; at = NR }
    { n++ }
    END { told() }' CHANGELOG.md | report

# ---- Top level -------------------------------------------------------------------------------------------------------
if [ -e .git ]; then
    git ls-files | cut -d/ -f1 | sort -u | grep -v '^\.' | grep -vxE "${top_level// /|}" |
        sed 's/$/:1: not one of the rooms of the top level/' | report || true
fi

# ---- Commits: an imperative of at most 60 characters, since this became a rule ---------------------------------------
rule=2f01c563711a
if [ -e .git ] && git cat-file -e $rule 2>/dev/null; then
    git log --no-merges --format='%h %s' $rule..HEAD | while read -r commit subject; do
        first=${subject%% *}
        [ ${#subject} -le 60 ] || echo "commit $commit: a subject of ${#subject} characters, more than 60"
        case $first in
        Bring | Embed | Feed | Focus | Speed) ;;
        *ed | *ing | *[!s]s | [!A-Z]*) echo "commit $commit: '$first' is no imperative" ;;
        esac
    done | report
fi

# ---- All versions agree with that of the Makefile --------------------------------------------------------------------
version=$(make -s print-VERSION)
grep -qx "version: $version" CITATION.cff || echo "CITATION.cff:1: version is not the Makefile's, $version" | report
recipes=$(cat tools/packages/conda/meta.yaml tools/packages/spack/package.py)
for words in "  version: $version" "version(\"$version\")" "hifdm-$version.tar"; do
    [[ $recipes == *"$words"* ]] || echo "tools/packages:1: a version is not the Makefile's, $version" | report
done
[ "$(grep -m 1 '^## \[' CHANGELOG.md | cut -d'[' -f2 | cut -d']' -f1)" = "$version" ] ||
    echo "CHANGELOG.md:1: the first version is not the Makefile's, $version" | report

# ---- Suites: each is in the file after which it is called ------------------------------------------------------------
sed -nE 's/^(SUITE|MIRROR)\((.*)\)$/\2/p' tests/suites.list.h | tr -d ' ' | while IFS=, read -r kind room name; do
    file=tests/$kind/${name:+$room/}test_${name:-$room}.c
    [ -e "$file" ] || echo "tests/suites.list.h:1: there is no $file"
done | report

# ---- Mutants: edits that no longer apply, which `make mutants` would find only after hours ---------------------------
"${PYTHON:-/usr/bin/python3}" tools/mutants.py --check 2>&1 | grep -vE '^[0-9]+ mutants$' | report || true

# ---- Other programs, if installed ------------------------------------------------------------------------------------
skipped=""
if command -v cppcheck >/dev/null; then
    # missingIncludeSystem: system headers are not checked. normalCheckLevel...: a note that is printed like a finding.
    cppcheck --quiet --std=c11 --language=c -j "$(nproc)" --enable=warning,performance,portability --inline-suppr \
        --suppress=missingIncludeSystem --suppress=normalCheckLevelMaxBranches --suppress=unmatchedSuppression \
        -Iinclude -Isrc --template='{file}:{line}: cppcheck: {message} [{id}]' src 2>&1 | report
else
    skipped="$skipped cppcheck"
fi
if command -v clang-format >/dev/null; then
    clang-format --dry-run -Werror $c_files 2>&1 |
        sed -nE 's/^([^:]*:[0-9]+):[0-9]+: error: .*/\1: not as clang-format lays it out/p' | uniq | report
else
    skipped="$skipped clang-format"
fi

for program in $skipped; do
    echo "skipped: lint: no $program"
    [ -z "${HIFDM_SKIPPED:-}" ] || echo "lint: no $program" >>"$HIFDM_SKIPPED"
    [ "${HIFDM_NO_SKIP:-}" != 1 ] || echo "tools/setup.sh:1: $program is missing, and HIFDM_NO_SKIP=1" | report
done
n_finding=$(cat "$findings" 2>/dev/null | wc -l)
echo "lint: $n_finding findings in $(echo "$text_files" | wc -l) files"
[ "$n_finding" = 0 ]
