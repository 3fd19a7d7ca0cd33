# Prints `length file:line` of every function that is longer than `most` lines. Reads what strip_comments.awk prints.
# A function is a block in braces behind parentheses that stands in nothing but namespaces and types; what stands in
# it (lambdas, loops) is a part of it. Of #if ... #else ... both sides are read, each as if the other were not there.
function push(what, since) {
  ++depth
  kind[depth] = what
  start[depth] = since
}
function opened(line,   what) {
  if (depth > 0 && kind[depth] != "space") what = "inner"
  else if (header ~ /^[ \t]*(,.*)?$/ && last_kind == "function") { push("function", last_start); return }
  else if (header ~ /=[ \t]*$/ || header !~ /[A-Za-z0-9_"]/) what = "inner"
  else if (header ~ /(^|[^A-Za-z0-9_])(namespace|extern)([^A-Za-z0-9_]|$)/ && header !~ /\(/) what = "space"
  else if (header ~ /\)/) what = "function"
  else if (header ~ /(^|[^A-Za-z0-9_])(struct|class|union)([^A-Za-z0-9_]|$)/) what = "space"
  else what = "inner"
  push(what, header_line > 0 ? header_line : line)
}
function closed(line) {
  if (depth == 0) return
  last_kind = kind[depth]
  last_start = start[depth]
  if (last_kind == "function" && line - last_start + 1 > most) print line - last_start + 1, file ":" last_start
  --depth
}
function fresh() { header = ""; header_line = 0 }
{
  first = index($0, ":")
  here = substr($0, 1, first - 1)
  rest = substr($0, first + 1)
  second = index(rest, ":")
  line = substr(rest, 1, second - 1) + 0
  text = substr(rest, second + 1)
  if (here != file) { file = here; depth = 0; ifs = 0; last_kind = ""; directive = 0; fresh() }
  if (directive || text ~ /^[ \t]*#/) {
    if (!directive) {
      if (text ~ /^[ \t]*#[ \t]*if/) saved[++ifs] = depth
      else if (text ~ /^[ \t]*#[ \t]*el/ && ifs > 0) { depth = saved[ifs]; fresh() }
      else if (text ~ /^[ \t]*#[ \t]*endif/ && ifs > 0) --ifs
    }
    directive = text ~ /\\[ \t]*$/
    next
  }
  while (match(text, /[{};]/)) {
    c = substr(text, RSTART, 1)
    before = substr(text, 1, RSTART - 1)
    text = substr(text, RSTART + 1)
    if (before ~ /[^ \t]/ && header_line == 0) header_line = line
    header = header before
    if (c == "{") opened(line)
    else if (c == "}") closed(line)
    else last_kind = ""
    fresh()
  }
  if (text ~ /[^ \t]/) {
    if (header_line == 0) header_line = line
    header = header text " "
    # What a template or an access label says does not begin a function.
    if (header ~ /^[ \t]*(public|private|protected):[ \t]*$/) fresh()
  }
}
