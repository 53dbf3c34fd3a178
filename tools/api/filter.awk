# Turns the plain comments of a public header into those that doxygen reads. Headers need no mark-up for it:
#   the comment at the top              describes the file (that of hifdm.h is the main page, too)
#   a comment right above declarations  describes them all, up to the next blank line
#   a comment behind a member           describes it, and each of `double *a, *b;`
#   a comment with a blank line below   belongs to the file; /* ---- heading ---- */ stays a comment
#   X(...) rows of a list               become the members that they make, where a struct or an enumeration of the same
#                                       header takes the list; described by a comment behind the row, or its last text
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

# ---- lists: #define LIST(X) X(...) X(...) and, inside a struct, #define MEMBER(type, name, ...) type name; ----

# Macros of this header: parameters_of[name], body_of[name].
function read_macros(    i, s, name, open)
{
    for (i = 1; i <= n_line; i++) {
        if (line[i] !~ /^[ \t]*#[ \t]*define[ \t]+[A-Za-z_0-9]+\(/) continue
        for (s = line[i]; s ~ /\\$/ && i < n_line; ) { sub(/[ \t]*\\$/, "", s); s = s " " line[++i] }
        sub(/^[ \t]*#[ \t]*define[ \t]+/, "", s)
        open = index(s, "(")
        name = substr(s, 1, open - 1)
        s = substr(s, open + 1)
        parameters_of[name] = substr(s, 1, index(s, ")") - 1)
        body_of[name] = substr(s, index(s, ")") + 1)
        gsub(/^[ \t]+|[ \t]+$/, "", body_of[name])
    }
}

# s, which begins behind a "(", up to its ")": argument[1..n_argument]; returns what stands behind it.
function take_arguments(s,    k, c, deep, quoted, now)
{
    n_argument = 0
    deep = quoted = 0
    now = ""
    for (k = 1; k <= length(s); k++) {
        c = substr(s, k, 1)
        if (c == "\"" && substr(s, k - 1, 1) != "\\") quoted = !quoted
        if (!quoted && c == ")" && deep == 0) break
        if (!quoted) deep += (c == "(") - (c == ")")
        if (!quoted && deep == 0 && c == ",") { argument[++n_argument] = now; now = "" }
        else now = now c
    }
    argument[++n_argument] = now
    for (c = 1; c <= n_argument; c++) gsub(/^[ \t]+|[ \t]+$/, "", argument[c])
    return substr(s, k + 1)
}

# The body of a macro with its arguments in place.
function filled(macro,    n, parameter, k, rest, out, word)
{
    n = split(parameters_of[macro], parameter, /[ \t]*,[ \t]*/)
    rest = body_of[macro]
    out = ""
    while (match(rest, /[A-Za-z_][A-Za-z_0-9]*/)) {
        word = substr(rest, RSTART, RLENGTH)
        for (k = 1; k <= n; k++) if (parameter[k] == word) { word = argument[k]; break }
        out = out substr(rest, 1, RSTART - 1) word
        rest = substr(rest, RSTART + RLENGTH)
    }
    out = out rest
    gsub(/[ \t]*##[ \t]*/, "", out)
    return out
}

function put_list(list, macro,    rest, comment, at)
{
    rest = body_of[list]
    while ((at = index(rest, "X(")) > 0) {
        rest = take_arguments(substr(rest, at + 2))
        comment = ""
        if (match(rest, /^[ \t]*\/\*/)) {
            comment = substr(rest, RSTART + RLENGTH, index(rest, "*/") - RSTART - RLENGTH)
            rest = substr(rest, index(rest, "*/") + 2)
        } else if (argument[n_argument] ~ /^".*"$/) {
            comment = argument[n_argument]
            gsub(/^"|"$/, "", comment)
        }
        gsub(/^[ \t]+|[ \t]+$/, "", comment)
        print filled(macro) (comment == "" ? "" : " /**< " escaped(comment) " */")
    }
}

# A list taken inside a struct or an enumeration, or in one on this line?
function put_if_list(s,    list, macro, before, after)
{
    if (!match(s, /HF_[A-Z_0-9]+\(HF_[A-Z_0-9]+\)/)) return 0
    before = substr(s, 1, RSTART - 1)
    after = substr(s, RSTART + RLENGTH)
    list = substr(s, RSTART, RLENGTH - 1)
    macro = list
    sub(/\(.*/, "", list)
    sub(/.*\(/, "", macro)
    if (parameters_of[list] != "X" || !(macro in body_of) || body_of[macro] !~ /[;,]$/) return 0
    if (!(depth > 0 && before after ~ /^[ \t]*$/) && before !~ /\{[ \t]*$/) return 0
    if (before !~ /^[ \t]*$/) print before
    put_list(list, macro)
    if (after !~ /^[ \t]*$/) print after
    return 1
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
    last = put_if_list(line[i]) ? i : put_code(i)
    follow(line[i])
    return last
}

{ line[++n_line] = $0 }

END {
    name = FILENAME
    sub(/.*\//, "", name)
    read_macros()
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
