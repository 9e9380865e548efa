#include "core/quantity.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "core/error.hpp"
#include "core/nearest.hpp"

namespace repose {
namespace {

struct Unit {
  std::string_view symbol;
  double factor;
  Dimension dimension;
  bool prefixed;  ///< takes SI prefixes
};

constexpr double radians_per_degree = std::numbers::pi / 180;

// `g` and not `kg` is the symbol that takes prefixes.
const std::array units{
    Unit{"m", 1, dimension::length, true},
    Unit{"g", 1e-3, dimension::mass, true},
    Unit{"s", 1, dimension::time, true},
    Unit{"K", 1, dimension::temperature, true},
    Unit{"N", 1, dimension::force, true},
    Unit{"Pa", 1, {-1, 1, -2, 0, 0}, true},
    Unit{"J", 1, {2, 1, -2, 0, 0}, true},
    Unit{"Hz", 1, dimension::frequency, true},
    Unit{"P", 0.1, dimension::viscosity, true},
    Unit{"L", 1e-3, {3, 0, 0, 0, 0}, true},
    Unit{"l", 1e-3, {3, 0, 0, 0, 0}, true},
    Unit{"min", 60, dimension::time, false},
    Unit{"h", 3600, dimension::time, false},
    Unit{"t", 1000, dimension::mass, false},
    Unit{"micron", 1e-6, dimension::length, false},
    Unit{"rad", 1, dimension::angle, true},
    Unit{"deg", radians_per_degree, dimension::angle, false},
    Unit{"°", radians_per_degree, dimension::angle, false},
    Unit{"rpm", std::numbers::pi / 30, dimension::angular_velocity, false},
    Unit{"%", 0.01, dimension::none, false},
    Unit{"1", 1, dimension::none, false},
};

struct Prefix {
  std::string_view symbol;
  double factor;
};
// The two micro signs are different characters (U+00B5, U+03BC).
constexpr std::array prefixes{Prefix{"p", 1e-12},     Prefix{"n", 1e-9}, Prefix{"u", 1e-6}, Prefix{"\u00b5", 1e-6},
                              Prefix{"\u03bc", 1e-6}, Prefix{"m", 1e-3}, Prefix{"c", 1e-2}, Prefix{"d", 1e-1},
                              Prefix{"k", 1e3},       Prefix{"M", 1e6},  Prefix{"G", 1e9}};

struct Scale {
  double factor = 1;
  Dimension dimension;
};

std::optional<Scale> find_unit(std::string_view symbol) {
  for (const Unit& unit : units)
    if (unit.symbol == symbol) return Scale{unit.factor, unit.dimension};
  for (const Prefix& prefix : prefixes) {
    if (!symbol.starts_with(prefix.symbol)) continue;
    for (const Unit& unit : units)
      if (unit.prefixed && unit.symbol == symbol.substr(prefix.symbol.size()))
        return Scale{prefix.factor * unit.factor, unit.dimension};
  }
  return std::nullopt;
}

std::vector<std::string> common_units() {
  return {"m",   "cm",  "mm",    "um",    "nm",  "kg",   "g",    "mg",   "ug",   "s",   "ms",
          "us",  "min", "N",     "mN",    "uN",  "nN",   "Pa",   "J",    "Hz",   "kHz", "rpm",
          "rad", "deg", "kg/m3", "g/cm3", "m/s", "mm/s", "m/s2", "Pa s", "rad/s"};
}

[[noreturn]] void unknown_unit(std::string_view unit) {
  const std::string near = nearest(unit, common_units());
  throw Error("",
              fmt::format("unknown unit `{}`{}", unit, near.empty() ? "" : fmt::format("; did you mean `{}`?", near)),
              "units are products of m, g, s, K, N, Pa, J, Hz, min, rad, deg, rpm with prefixes and powers, as in "
              "\"58 um\", \"1.02 g/cm3\", \"127 mm/s\"");
}

void multiply(Scale& total, const Scale& unit, int power) {
  total.factor *= std::pow(unit.factor, power);
  total.dimension.length += power * unit.dimension.length;
  total.dimension.mass += power * unit.dimension.mass;
  total.dimension.time += power * unit.dimension.time;
  total.dimension.temperature += power * unit.dimension.temperature;
  total.dimension.angle += power * unit.dimension.angle;
}

bool take(std::string_view& text, std::string_view start) {
  if (!text.starts_with(start)) return false;
  text.remove_prefix(start.size());
  return true;
}

// A `/` divides by everything up to the next `*` or `/`: "kg/m s" is kg/(m s), as one writes it by hand.
Scale parse_unit(std::string_view text) {
  const std::string_view whole = text;
  Scale total;
  int sign = 1;
  bool expects_symbol = true;
  while (!text.empty()) {
    if (take(text, " ") || take(text, "\t") || take(text, "·") || take(text, ".")) continue;
    if (text.front() == '/' || text.front() == '*') {
      if (expects_symbol) unknown_unit(whole);
      sign = text.front() == '/' ? -1 : 1;
      text.remove_prefix(1);
      expects_symbol = true;
      continue;
    }
    const std::size_t end = text.find_first_of(" \t*/.^+-0123456789", text.front() == '1' ? 1 : 0);
    std::string_view symbol = text.substr(0, end);
    for (const std::string_view stop : {"²", "³", "·", "⁻"}) symbol = symbol.substr(0, symbol.find(stop));
    text.remove_prefix(symbol.size());
    const std::optional<Scale> unit = find_unit(symbol);
    if (!unit) unknown_unit(symbol.empty() ? whole : symbol);

    int power = 1;
    const bool caret = take(text, "^");
    if (take(text, "²")) {
      power = 2;
    } else if (take(text, "³")) {
      power = 3;
    } else if (take(text, "⁻¹")) {
      power = -1;
    } else if (text.find_first_of("+-0123456789") == 0) {
      take(text, "+");
      const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), power);
      if (error != std::errc() || std::abs(power) > 9) unknown_unit(whole);
      text.remove_prefix(static_cast<std::size_t>(rest - text.data()));
    } else if (caret) {
      unknown_unit(whole);
    }
    multiply(total, *unit, sign * power);
    expects_symbol = false;
  }
  if (expects_symbol) unknown_unit(whole);
  return total;
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  return text;
}

bool is_not_finite(std::string_view text) {
  if (!text.empty() && (text.front() == '-' || text.front() == '+')) text.remove_prefix(1);
  if (!text.empty() && text.front() == '.') text.remove_prefix(1);
  std::string lower(text);
  for (char& c : lower)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return lower == "nan" || lower == "inf" || lower == "infinity" || lower.starts_with("nan ") ||
         lower.starts_with("inf ");
}

std::string expectation(const Dimension& expected) {
  return expected == dimension::none ? "a plain number"
                                     : fmt::format("a number in {} or one with a unit", unit_of(expected));
}

}  // namespace

std::string unit_of(const Dimension& d) {
  if (d == dimension::none) return "1";
  if (d == dimension::force) return "N";
  if (d == dimension::viscosity) return "Pa s";
  if (d == dimension::frequency) return "Hz";
  if (d == dimension::stiffness) return "N/m";
  if (d == dimension::damping) return "N s/m";
  struct Factor {
    std::string_view symbol;
    int power;
  };
  const std::array factors{Factor{"kg", d.mass}, Factor{"rad", d.angle}, Factor{"m", d.length}, Factor{"s", d.time},
                           Factor{"K", d.temperature}};
  std::string above, below;
  for (const auto& [symbol, power] : factors) {
    std::string& side = power > 0 ? above : below;
    if (power == 0) continue;
    if (!side.empty()) side += " ";
    side += symbol;
    if (std::abs(power) > 1) side += fmt::format("^{}", std::abs(power));
  }
  return (above.empty() ? "1" : above) + (below.empty() ? "" : "/" + below);
}

double parse_quantity(std::string_view text, const Dimension& expected) {
  const std::string_view given = trimmed(text);
  if (given.empty()) throw Error("", "empty; expected " + expectation(expected), "write a value, or leave the key out");
  if (is_not_finite(given))
    throw Error("", fmt::format("`{}` is not a finite number", given), "write " + expectation(expected));

  std::string_view rest = given;
  const bool plus = take(rest, "+");
  double value = 0;
  const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), value);
  if (error == std::errc::result_out_of_range || std::fpclassify(value) == FP_SUBNORMAL)
    throw Error("", fmt::format("`{}` is beyond the range of numbers", given), "write " + expectation(expected));
  if (error != std::errc() || (plus && rest.front() == '-') || !std::isfinite(value))
    throw Error("", fmt::format("`{}` is not a number", given), "write " + expectation(expected));
  rest.remove_prefix(static_cast<std::size_t>(end - rest.data()));
  if (rest.empty()) return value;
  if (rest.front() == ',')
    throw Error("", fmt::format("`{}` is not a number", given), "write a decimal point, not a comma");

  const std::string_view unit_text = trimmed(rest);
  if (unit_text.find_first_of("+-0123456789") == 0 && !unit_text.starts_with("1/"))
    throw Error("", fmt::format("`{}` holds more than one number", given), "write " + expectation(expected));
  const Scale scale = parse_unit(unit_text);
  if (!(scale.dimension == expected))
    throw Error("", fmt::format("`{}` is in {}; expected {}", given, unit_of(scale.dimension), unit_of(expected)),
                "write " + expectation(expected));
  const double result = value * scale.factor;
  if (!std::isfinite(result) || (value != 0 && !std::isnormal(result)))
    throw Error("", fmt::format("`{}` is beyond the range of numbers", given), "write " + expectation(expected));
  return result;
}

}  // namespace repose
