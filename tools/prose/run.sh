#!/usr/bin/env bash
# Checks the words of all documents and of the program by the rules in terms.yml: `make prose`. Prints file:line:column,
# the words found and what to write. Needs node and npm (tools/setup.sh --ci); textlint is installed under build/prose.
set -eu
cd "$(dirname "$0")/../.."
work=$(realpath -m "${BUILD:-build}")/prose here=$PWD

# Leaves the check out if there is no npm or no network, but never in CI.
skip() {
    echo "make prose: $1; the words are not checked" >&2
    [ -z "${HIFDM_SKIPPED:-}" ] || echo "prose: $1" >>"$HIFDM_SKIPPED"
    [ "${HIFDM_NO_SKIP:-}" != 1 ] || exit 1
    exit 0
}

command -v npm >/dev/null || skip "no npm"
mkdir -p "$work"
if ! cmp -s tools/prose/package-lock.json "$work/package-lock.json" || [ ! -d "$work/node_modules" ]; then
    cp tools/prose/package.json tools/prose/package-lock.json "$work/"
    (cd "$work" && npm ci --no-audit --no-fund --loglevel=error) || skip "npm cannot install textlint"
fi
cat >"$work/textlintrc.json" <<JSON
{"rules": {"prh": {"rulePaths": ["$here/tools/prose/terms.yml"], "checkLink": true, "checkEmphasis": true}}}
JSON

rm -rf "$work/text"
/usr/bin/python3 tools/prose/strings.py "$work/text"
# Names of 0.2 and words that the glossary explains as former names are no findings.
documents=$(git ls-files '*.md' | grep -vxF -e src/manual/renames.md -e src/manual/glossary.md)
for file in $documents; do
    mkdir -p "$work/text/$(dirname "$file")"
    cp "$file" "$work/text/$file"
done
lint() { # FILE...
    (cd "$work" && node_modules/.bin/textlint --config textlintrc.json --format unix "$@")
}

# The rules find what they must in a text with one mistake for each, and nothing in a clean text.
mkdir -p "$work/trial"
/usr/bin/python3 - tools/prose/terms.yml "$work/trial" <<'PYTHON'
import re, sys
specs = re.findall(r"\{from: ([^,}]*), to: ([^}]*)\}", open(sys.argv[1], encoding="utf-8").read())
froms = [(wrong, right) for wrong, right in specs if wrong != right]
open(sys.argv[2] + "/wrong.md", "w").write("\n\n".join(f for f, _ in froms) + "\n")
open(sys.argv[2] + "/right.md", "w").write("\n\n".join(t.replace("(delete this)", "") for _, t in froms) + "\n")
print(len(froms), file=open(sys.argv[2] + "/n", "w"))
PYTHON
found=$(lint trial/wrong.md | grep -c '^/' || true)
if [ "$found" != "$(cat "$work/trial/n")" ]; then
    echo "make prose: the rules find $found of $(cat "$work/trial/n") mistakes"
    exit 1
fi
lint trial/right.md >/dev/null || { echo "make prose: the rules find mistakes in what they propose"; exit 1; }

code=0
lint text >"$work/report" || code=1
sed -E "s|^$work/text/||; s|\.(c\|h\|js\|html\|py)\.md:|.\1:|; s|\[Error/prh\]||" "$work/report" >"$work/findings"
grep -E '^[^ ]+:[0-9]+:' "$work/findings" | sort -u || true
n=$(grep -cE '^[^ ]+:[0-9]+:' "$work/findings" || true)
echo "prose: $n findings in $(find "$work/text" -name '*.md' | wc -l) texts"
[ "$n" = 0 ] && [ "$code" = 0 ]
