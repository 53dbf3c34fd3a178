#!/usr/bin/env bash
# The rules of the house that a program can check. Each finding is one line, file:line: text; exit status 1 if any.
set -eu
export LC_ALL=C.UTF-8
cd "$(dirname "$0")/.."

# ---- The rules' own lists: change them here when the house changes ---------------------------------------------------
# may call malloc and its kin: set-up, never the hot path
heap_files="status arena text csv scene scene_import config numbering model lane batch hdf5_io hdf5_io_rows journal
            generations store_file store_open store store_read store_resume compare truss truss_import frame
            carrier store_truss store_coupling study study_read ledger merge sweep options problem run designs"
# may print (csv, json, summary: to a stream they are given)
print_files="csv json summary help print progress plan export cutlist report report_study designs sweep main"
openmp_files="batch"                                 # may mention OpenMP
top_level="Makefile README.md LICENSE src include configs tests results tools"   # and dot-files
max_file=600 max_function=80 long_function=60                        # lines; between the last two it is a warning

library=$(make -s print-MODULES)
page=$(make -s print-PAGE)                           # parts of the page that `report` writes
modules="$library $(make -s print-APP_MODULES)"

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
findings=$work/findings
report() { tee -a "$findings"; }
# Tracked and new files alike, so that lint speaks before the commit does; in a tarball, whatever is there.
files_under() {
    if [ -e .git ]; then
        git ls-files -co --exclude-standard -- "$@" | while read -r file; do [ ! -e "$file" ] || echo "$file"; done
    else
        find "$@" -type f
    fi | sort
}
source_files=$(files_under src include | grep '\.[ch]$' || true)
# Without files the tools below would wait for standard input.
[ -n "$source_files" ] || { echo "lint: no sources found (does git ls-files work here?)" >&2; exit 1; }
c_files=$(files_under src include tests | grep '\.[ch]$')
text_files=$(files_under src include tests tools configs .ci Makefile README.md |
    grep -E '\.(c|h|sh|py|ya?ml|md|html|css|js|mjs)$|^\.ci/|^Makefile$')

# ---- Modules: only the listed ones, one header each, includes only upward in the list --------------------------------
seen=""
for module in $modules; do
    [ -e src/$module.c ] || echo "src/$module.c:1: module listed in the Makefile has no source"
    if [ -e src/$module.h ] && [ -e include/hifdm/$module.h ]; then
        echo "src/$module.h:1: module has two headers, this one and include/hifdm/$module.h"
    elif [ -e src/$module.h ] || [ -e include/hifdm/$module.h ] || [ $module = main ]; then
        :
    elif [[ " $seen " != *" ${module%_*} "* ]]; then   # X_part implements a part of X and shares its header
        echo "src/$module.c:1: module has no header"
    fi
    seen="$seen $module"
done | report

files_under src include | while read -r file; do
    name=$(basename "${file%.[ch]}")
    case $file in
    include/hifdm/hifdm.h) continue ;;
    src/report/*) case " $page " in *" $file "*) continue ;; esac ;;
    src/*/* | include/hifdm/*/*) ;;
    src/*.c | src/*.h | include/hifdm/*.h) case " ${modules//$'\n'/ } " in *" $name "*) continue ;; esac ;;
    esac
    echo "$file:1: not a file of a module listed in the Makefile"
done | report

# hifdm.h includes everything, so it is for programs: the modules of the library name what they use.
awk -v modules="$modules" -v library="$library" '
    BEGIN { n = split(modules, list, /[ \n]+/); for (i = 1; i <= n; i++) rank[list[i]] = i
            n_library = split(library, list, /[ \n]+/) }
    FNR == 1 { self = FILENAME; sub(/.*\//, "", self); sub(/\.[ch]$/, "", self) }
    self != "hifdm" && /^[ \t]*#[ \t]*include[ \t]*("|<hifdm\/)/ {
        name = $0; sub(/^[^"<]*["<]/, "", name); sub(/[">].*/, "", name)
        other = name; sub(/^hifdm\//, "", other); sub(/\.h$/, "", other)
        if (other == self || (other == "hifdm" && rank[self] > n_library)) next
        if (!(other in rank)) print FILENAME ":" FNR ": includes " name ", which is no header of a module"
        else if (rank[other] > rank[self])
            print FILENAME ":" FNR ": " self " includes " other ", which is below it in the list of modules"
    }' $source_files | report

# ---- Sizes -----------------------------------------------------------------------------------------------------------
# A function is what stands between a { and a } in column 0; its lines are those in between.
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
# search PATTERN MESSAGE FILE...; the brackets in the patterns below keep them from finding themselves.
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

# ---- Calls that belong to few modules --------------------------------------------------------------------------------
# Looked for in the code without its comments and literals, laid out as file:line:code.
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

# only_in "MODULE..." PATTERN MESSAGE
only_in() {
    grep -vE "^(src|include/hifdm)/(${1// /|})\.[ch]:" "$work/code" | grep -E "^[^:]*:[0-9]+:.*($2)" |
        sed -E "s#^([^:]*:[0-9]+):.*#\1: $3 (allowed in: $1)#" | report || true
}
heap_files=$(echo $heap_files)
only_in main '\bgsl_set_error_handler' 'setting the error handler of the whole program'
only_in "$heap_files" '\b(malloc|calloc|realloc|aligned_alloc|posix_memalign|strdup|strndup)[[:blank:]]*\(' 'heap call'
only_in "$print_files" '\b(v?f?printf|f?puts|f?putc|putchar|perror|exit|_Exit|abort)[[:blank:]]*\(' 'prints or exits'
only_in "$openmp_files" '\bomp(\b|_)|\b_OPENMP\b' 'OpenMP'

# ---- Top level -------------------------------------------------------------------------------------------------------
if [ -e .git ]; then
    git ls-files | cut -d/ -f1 | sort -u | grep -v '^\.' | grep -vxE "${top_level// /|}" |
        sed 's/$/:1: not one of the rooms of the top level/' | report || true
fi

# ---- Other programs, where installed ---------------------------------------------------------------------------------
skipped=""
if command -v cppcheck >/dev/null; then
    # missingIncludeSystem: it need not see the headers of others. normalCheckLevel...: not a finding, but said as one.
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

[ -z "$skipped" ] || echo "not installed, so not run:$skipped"
n_finding=$(cat "$findings" 2>/dev/null | wc -l)
echo "lint: $n_finding findings in $(echo "$text_files" | wc -l) files"
[ "$n_finding" = 0 ]
