#include "analysis/report/markup.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>

namespace repose::report {

std::string escaped(std::string_view text) {
  std::string result;
  result.reserve(text.size());
  for (const char c : text) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      case '\'':
        result += "&#39;";
        break;
      default:
        result += c;
    }
  }
  return result;
}

std::string base64(std::string_view bytes) {
  static constexpr char alphabet[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string result;
  result.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t left = bytes.size() - i;
    const auto byte = [&](std::size_t k) {
      return k < left ? static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[i + k])) : 0U;
    };
    const std::uint32_t group = byte(0) << 16U | byte(1) << 8U | byte(2);
    result += alphabet[group >> 18U];
    result += alphabet[group >> 12U & 63U];
    result += left > 1 ? alphabet[group >> 6U & 63U] : '=';
    result += left > 2 ? alphabet[group & 63U] : '=';
  }
  return result;
}

std::string number(double value, int digits) {
  if (std::isnan(value)) return "";
  if (std::isinf(value)) return value > 0 ? "∞" : "−∞";
  const std::string text = fmt::format("{:.{}g}", value, digits);
  const std::size_t e = text.find('e');
  if (e == std::string::npos) return text;
  // 2.31e-05 as 2.31×10⁻⁵.
  static constexpr const char* raised[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string result = text.substr(0, e) + "×10" + (text[e + 1] == '-' ? "⁻" : "");
  for (const char digit : std::to_string(std::stoi(text.substr(e + 2)))) result += raised[digit - '0'];
  return result;
}

}  // namespace repose::report
