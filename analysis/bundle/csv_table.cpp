#include "analysis/bundle/csv_table.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <limits>
#include <set>

#include "core/atomic_file.hpp"
#include "core/error.hpp"

namespace repose {
namespace {

constexpr std::uintmax_t largest_file = 512'000'000;

std::string trimmed(const std::string& text) {
  const std::size_t from = text.find_first_not_of(" \t");
  if (from == std::string::npos) return "";
  return text.substr(from, text.find_last_not_of(" \t") - from + 1);
}

bool is_number(const std::string& text, double& value) {
  const char* begin = text.data() + (text.starts_with('+') ? 1 : 0);
  const auto [end, error] = std::from_chars(begin, text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size();
}

/// Takes records from a text, one after the other.
class Reader {
 public:
  Reader(const std::string& text, const std::string& name) : text_(text), name_(name) {
    if (text_.starts_with("\xef\xbb\xbf")) at_ = 3;
  }

  /// False at the end. `line`: where the record begins.
  bool next(std::vector<std::string>& fields, int& line) {
    fields.clear();
    if (at_ >= text_.size()) return false;
    line = line_;
    std::string field;
    bool more = true;
    while (more) {
      field.clear();
      const bool quoted = skip_blanks_before_quote();
      if (quoted) take_quoted(field, line);
      while (at_ < text_.size() && text_[at_] != ',' && text_[at_] != '\n') {
        const char c = text_[at_++];
        if (c == '\r' && (at_ >= text_.size() || text_[at_] == '\n')) continue;
        if (quoted && c != ' ' && c != '\t')
          throw Error(fmt::format("{}:{}", name_, line), "text follows a closing quote",
                      "double a quote that is part of the text, and put a comma behind the last");
        field += c;
      }
      fields.push_back(trimmed(field));
      more = at_ < text_.size() && text_[at_] == ',';
      if (at_ < text_.size()) {
        if (text_[at_] == '\n') ++line_;
        ++at_;
      }
    }
    return true;
  }

 private:
  bool skip_blanks_before_quote() {
    std::size_t ahead = at_;
    while (ahead < text_.size() && (text_[ahead] == ' ' || text_[ahead] == '\t')) ++ahead;
    if (ahead >= text_.size() || text_[ahead] != '"') return false;
    at_ = ahead + 1;
    return true;
  }
  void take_quoted(std::string& field, int line) {
    for (;; ++at_) {
      if (at_ >= text_.size())
        throw Error(fmt::format("{}:{}", name_, line), "a quote is not closed", "close it, or remove it");
      if (text_[at_] == '\n') ++line_;
      if (text_[at_] != '"') {
        field += text_[at_];
      } else if (at_ + 1 < text_.size() && text_[at_ + 1] == '"') {
        field += '"';
        ++at_;
      } else {
        ++at_;
        return;
      }
    }
  }

  const std::string& text_;
  const std::string& name_;
  std::size_t at_ = 0;
  int line_ = 1;
};

void check_header(const CsvTable& table, int line) {
  const std::string place = fmt::format("{}:{}", table.name, line);
  std::set<std::string> seen;
  for (const std::string& name : table.column) {
    double ignored = 0;
    if (name.empty()) throw Error(place, "a column has no name", "the first line names every column");
    if (is_number(name, ignored))
      throw Error(place, fmt::format("the first line holds the number {}; it must name the columns", name),
                  "put a header line in front, such as `time,body,x,y,z`");
    if (!seen.insert(name).second)
      throw Error(place, fmt::format("column `{}` is there twice", name), "rename or remove one of them");
  }
}

}  // namespace

int CsvTable::find(const std::string& header) const {
  for (std::size_t i = 0; i < column.size(); ++i)
    if (column[i] == header) return static_cast<int>(i);
  return -1;
}

std::string CsvTable::place(const CsvRow& row, int index) const {
  return fmt::format("{}:{}: column `{}`", name, row.line, column[static_cast<std::size_t>(index)]);
}

double CsvTable::number(const CsvRow& row, int index) const {
  const std::string& text = row.field[static_cast<std::size_t>(index)];
  if (text.empty()) return std::numeric_limits<double>::quiet_NaN();
  double value = 0;
  if (!is_number(text, value))
    throw Error(
        place(row, index), fmt::format("`{}` is not a number", text),
        "write a number with a decimal point, without a unit; leave the field empty where nothing was observed");
  if (!std::isfinite(value))
    throw Error(place(row, index), fmt::format("`{}` is not a finite number", text),
                "leave the field empty where nothing was observed");
  return value;
}

CsvTable parse_csv(const std::string& text, const std::string& name) {
  if (text.find('\0') != std::string::npos)
    throw Error(name, "not a text file (it holds NUL bytes)", "give a CSV file");
  CsvTable table;
  table.name = name;
  Reader reader(text, name);
  std::vector<std::string> fields;
  int line = 0;
  const auto blank = [&] { return fields.size() == 1 && fields[0].empty(); };
  do {
    if (!reader.next(fields, line))
      throw Error(name, "empty", "the first line names the columns, the others hold numbers");
  } while (blank());
  table.column = fields;
  check_header(table, line);
  while (reader.next(fields, line)) {
    if (blank()) continue;
    if (fields.size() > table.column.size())
      throw Error(fmt::format("{}:{}", name, line),
                  fmt::format("{} fields, but the header has {} columns", fields.size(), table.column.size()),
                  "a decimal comma, or a field too many? Columns are parted by commas, decimals by a point");
    fields.resize(table.column.size());
    table.rows.push_back({line, fields});
  }
  return table;
}

CsvTable read_csv(const std::filesystem::path& file) {
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored))
    throw Error(file.string(), "no such file", "check `file:` in recording.yaml, and --root if the data lie elsewhere");
  if (!std::filesystem::is_regular_file(file, ignored)) throw Error(file.string(), "not a file", "give a CSV file");
  if (std::filesystem::file_size(file, ignored) > largest_file)
    throw Error(file.string(), "is too large for one recording", "leave out samples, or part it into runs");
  return parse_csv(read_bytes(file), file.string());
}

std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + '"';
}

}  // namespace repose
