# in_json FILE PATH LINES: the number that stands so many lines below the key, as `repose` writes JSON: two blanks more for each block of
# PATH (roller/force), a line for each component of a vector.
in_json() {
  awk -v path="$2" -v below="$3" 'BEGIN { n = split(path, key, "/"); blanks = "  " }
    k < n && index($0, blanks "\"" key[k + 1] "\":") == 1 { blanks = blanks "  "; if (++k == n) at = NR + below }
    k == n && NR == at { sub(/.*: /, ""); gsub(/[ ,]/, ""); print; exit }' "$1"
}
