# Prints `file:line:text` of C++ sources with comments and the insides of string and character literals left out.
FNR == 1 { in_comment = 0 }
{
  out = ""
  quote = ""
  for (i = 1; i <= length($0); ++i) {
    c = substr($0, i, 1)
    pair = substr($0, i, 2)
    if (in_comment) {
      if (pair == "*/") { in_comment = 0; ++i }
    } else if (quote != "") {
      if (c == "\\") { ++i } else if (c == quote) { quote = ""; out = out c }
    } else if (pair == "/*") { in_comment = 1; ++i; out = out " "
    } else if (pair == "//") { break
    } else if (c == "\"" || (c == "'" && out !~ /[0-9A-Fa-f]$/)) { quote = c; out = out c
    } else { out = out c }
  }
  if (out ~ /[^ \t]/) { print FILENAME ":" FNR ":" out }
}
