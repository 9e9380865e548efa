#pragma once
/// The small change of HTML.
#include <string>
#include <string_view>

namespace repose::report {

/// The text with & < > " ' as entities: safe between tags and inside quoted attributes.
std::string escaped(std::string_view text);

/// RFC 4648.
std::string base64(std::string_view bytes);

/// A number as people read it: up to `digits` significant digits, exponents only where they help; "" for NaN.
std::string number(double value, int digits = 6);

}  // namespace repose::report
