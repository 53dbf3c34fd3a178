# Turns the plain comments of a public header into those that doxygen reads. Headers need no mark-up for it:
#   the comment at the top              describes the file (that of hifdm.h is the main page, too)
#   a comment right above declarations  describes them all, up to the next blank line
#   a comment behind a member           describes it, and each of `double *a, *b;`
#   a comment with a blank line below   belongs to the file; /* ---- heading ---- */ stays a comment
# Within a comment, three or more indented lines, or some after a blank line or a colon, stay as they are laid out.

function escaped(s)
{
    gsub(/[\\@]/, "\\\\&", s)
    gsub(/&/, "\\&amp;", s)
    gsub(/</, "\\&lt;", s)
    gsub(/>/, "\\&gt;", s)
    gsub(/#/, "\\\\#", s)
    gsub(/%/, "\\\\%", s)
    gsub(/"/, "\\\\\"", s)
    gsub(/::/, "\\\\::", s)
    gsub(/--/, "\\\\--", s)
    gsub(/Eq\. /, "Eq.\\ ", s) # the first sentence, which stands in lists, does not end here
    gsub(/Eqs\. /, "Eqs.\\ ", s)
    gsub(/Fig\. /, "Fig.\\ ", s)
    return s
}

function indent_of(s) { match(s, /^ */); return RLENGTH }

# text[1..n]: lines of a comment without its frame; what stands first in the block.
function put_comment(n, first,    k, run, before)
{
    print "/** " first
    for (k = 1; k <= n; k++) {
        before = k == 1 ? "" : text[k - 1]
        if (text[k] ~ /^ *$/) { print ""; continue }
        if (k > 1 && indent_of(text[k]) > 1) {
            for (run = 0; k + run <= n && indent_of(text[k + run]) > 1; run++) { }
            if (run >= 3 || before ~ /^ *$|:$/) {
                print "@verbatim"
                for (; run > 0; run--) print text[k++]
                print "@endverbatim"
                k--
                continue
            }
        }
        if (text[k] ~ /^ ?[A-Z][A-Za-z]+[.:] /) print ""
        print escaped(text[k])
        if (text[k] ~ /^ ?Stability: /) print ""
    }
    print "*/"
}

# The comment that begins in line i -> text[1..n_text]; returns the number of its last line, 0 when code follows it.
function read_comment(i,    s)
{
    n_text = 0
    for (; i <= n_line; i++) {
        s = line[i]
        if (n_text == 0) sub(/^[ \t]*\/\*/, "", s)
        else sub(/^[ \t]*\*?/, "", s)
        if (line[i] ~ /\*\//) {
            if (s !~ /\*\/[ \t]*$/) return 0
            sub(/[ \t]*\*\/[ \t]*$/, "", s)
            text[++n_text] = s
            return i
        }
        text[++n_text] = s
    }
    return 0
}

# `type a, *b;` with a comment, as lines of their own.
function put_members(code, comment,    blanks, part, n, k, type)
{
    match(code, /^[ \t]*/)
    blanks = substr(code, 1, RLENGTH)
    sub(/;[ \t]*$/, "", code)
    n = split(code, part, /,[ \t]*/)
    match(part[1], /\**[A-Za-z_0-9]+(\[[^]]*\])*$/)
    type = substr(part[1], 1, RSTART - 1)
    print part[1] "; /**< " comment " */"
    for (k = 2; k <= n; k++) print type part[k] "; /**< " comment " */"
}

# A line of code, perhaps with a comment behind it; returns the number of the last line that it took.
function put_code(i,    at, code, comment)
{
    at = index(line[i], "/*")
    if (at == 0 || line[i] ~ /\\$/) { print line[i]; return i }
    code = substr(line[i], 1, at - 1)
    comment = substr(line[i], at + 2)
    while (comment !~ /\*\/[ \t]*$/ && i < n_line) {
        if (comment ~ /\*\//) { print line[i]; return i } # code goes on behind it
        i++
        sub(/^[ \t]*\*?/, "", line[i])
        comment = comment " " line[i]
    }
    sub(/[ \t]*\*\/[ \t]*$/, "", comment)
    comment = escaped(comment)
    if (code ~ /[{(][ \t]*$/ && code !~ /enum/) print code
    else if (depth > 0 && !in_enum && code ~ /,/ && code ~ /;[ \t]*$/ && code !~ /[({]/) put_members(code, comment)
    else print code "/**< " comment " */"
    return i
}

function follow(s)
{
    gsub(/\/\*.*/, "", s)
    if (s ~ /extern "C"/) return
    if (s ~ /enum[^;]*\{/) in_enum = 1
    depth += gsub(/\{/, "{", s) - gsub(/\}/, "}", s)
    if (depth < 0) depth = 0
    if (depth == 0) in_enum = 0
}

function put_chunk(i,    last)
{
    last = put_code(i)
    follow(line[i])
    return last
}

{ line[++n_line] = $0 }

END {
    name = FILENAME
    sub(/.*\//, "", name)
    for (i = 1; i <= n_line; i++) {
        if (line[i] !~ /^[ \t]*\/\*/) { i = put_chunk(i); continue }
        last = read_comment(i)
        if (last == 0 || text[1] ~ /^ *-+ /) { print line[i]; continue }
        if (i == 1) {
            if (name == "hifdm.h") put_comment(n_text, "@mainpage hifdm\n")
            put_comment(n_text, "@file\n")
            i = last
            continue
        }
        if (depth > 0) { put_comment(n_text, ""); i = last; continue }
        if (last == n_line || line[last + 1] ~ /^[ \t]*$/) { put_comment(n_text, "@file\n"); i = last; continue }
        print "/** @{ */"
        put_comment(n_text, "")
        for (i = last + 1; i <= n_line && (depth > 0 || line[i] !~ /^[ \t]*$|^\/\*/); i++) {
            if (line[i] ~ /^[ \t]*\/\*/ && (last = read_comment(i)) > 0) { put_comment(n_text, ""); i = last }
            else i = put_chunk(i)
        }
        print "/** @} */"
        i--
    }
}
