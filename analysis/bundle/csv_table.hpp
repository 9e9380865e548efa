#pragma once
/// CSV files with a header line (RFC 4180 quoting), read strictly: every complaint names file, line and column.
#include <filesystem>
#include <string>
#include <vector>

namespace repose {

struct CsvRow {
  int line = 0;                    ///< of the file, from 1
  std::vector<std::string> field;  ///< as many as the header has; "" where the field is blank or missing
};

struct CsvTable {
  std::string name;                 ///< of the file, for messages
  std::vector<std::string> column;  ///< header, blanks trimmed
  std::vector<CsvRow> rows;         ///< blank lines left out

  /// Index of a column, -1 if there is none.
  int find(const std::string& header) const;
  /// The number in a field; NaN if the field is empty. Throws Error for anything else that is not a finite number.
  double number(const CsvRow& row, int column_index) const;
  /// "file:12: column `z`": for messages.
  std::string place(const CsvRow& row, int column_index) const;
};

/// Fields may be quoted ("a ""b"""), separated by commas; lines end with LF or CRLF; a byte order mark is skipped. Rows
/// shorter than the header lack their last fields. Throws Error for a missing, empty or binary file, a header with a
/// number, an empty or a doubled name, a row longer than the header, an open quote.
CsvTable read_csv(const std::filesystem::path& file);
CsvTable parse_csv(const std::string& text, const std::string& name);

/// A field as a CSV file holds it: quoted if it has to be.
std::string csv_field(const std::string& text);

}  // namespace repose
