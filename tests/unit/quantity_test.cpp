#include "core/quantity.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <string>
#include <vector>

#include "core/error.hpp"
#include "core/nearest.hpp"

namespace repose {
namespace {

TEST(Quantity, BareNumbersAreSi) {
  EXPECT_EQ(parse_quantity("58e-6", dimension::length), 58e-6);
  EXPECT_EQ(parse_quantity("  -1.5 ", dimension::velocity), -1.5);
  EXPECT_EQ(parse_quantity("+2", dimension::none), 2);
}

TEST(Quantity, UnitsScaleToSi) {
  const struct {
    const char* text;
    Dimension dimension;
    double si;
  } cases[] = {
      {"58 um", dimension::length, 58e-6},
      {"58um", dimension::length, 58e-6},
      {"58 µm", dimension::length, 58e-6},
      {"58 μm", dimension::length, 58e-6},
      {"1.02 g/cm3", dimension::density, 1020},
      {"1.02 g/cm^3", dimension::density, 1020},
      {"1.02 g/cm³", dimension::density, 1020},
      {"1020 kg m-3", dimension::density, 1020},
      {"127 mm/s", dimension::velocity, 0.127},
      {"9.81 m/s^2", dimension::acceleration, 9.81},
      {"0.5 mN", dimension::force, 5e-4},
      {"3 kg*m/s2", dimension::force, 3},
      {"0.018 mPa s", dimension::viscosity, 1.8e-5},
      {"1 cP", dimension::viscosity, 1e-3},
      {"2 N s/m", dimension::damping, 2},
      {"10 mg", dimension::mass, 1e-5},
      {"2 min", dimension::time, 120},
      {"50 Hz", dimension::frequency, 50},
      {"5 1/s", dimension::frequency, 5},
      {"30 rpm", dimension::angular_velocity, std::numbers::pi},
      {"180 deg/s", dimension::angular_velocity, std::numbers::pi},
      {"90 °", dimension::angle, std::numbers::pi / 2},
      {"1 ms", dimension::time, 1e-3},
      {"2 m s", {1, 0, 1, 0, 0}, 2},
      {"8 kg/m s", dimension::viscosity, 8},
      {"20 %", dimension::none, 0.2},
  };
  for (const auto& c : cases) EXPECT_DOUBLE_EQ(parse_quantity(c.text, c.dimension), c.si) << c.text;
}

std::string problem_of(const std::string& text, const Dimension& dimension) {
  try {
    parse_quantity(text, dimension);
  } catch (const Error& error) {
    EXPECT_FALSE(error.remedy().empty()) << text;
    return error.problem();
  }
  return "accepted";
}

TEST(Quantity, WrongDimensionIsNamed) {
  EXPECT_EQ(problem_of("58 ug", dimension::length), "`58 ug` is in kg; expected m");
  EXPECT_EQ(problem_of("2 Hz", dimension::angular_velocity), "`2 Hz` is in Hz; expected rad/s");
  EXPECT_EQ(problem_of("30 rpm", dimension::frequency), "`30 rpm` is in rad/s; expected Hz");
  EXPECT_EQ(problem_of("1 g/cm2", dimension::density), "`1 g/cm2` is in kg/m^2; expected kg/m^3");
}

TEST(Quantity, UnknownUnitNamesTheNearest) {
  EXPECT_EQ(problem_of("30 rmp", dimension::angular_velocity), "unknown unit `rmp`; did you mean `rpm`?");
  EXPECT_NE(problem_of("58 furlong", dimension::length).find("unknown unit"), std::string::npos);
}

TEST(Quantity, MalformedNumbersAreRefused) {
  const std::vector<std::string> bad{"",         " ",      "nan",    ".nan",      "NaN m",  "inf",   "-.inf",
                                     "Infinity", "abc",    "1,5",    "--1",       "+-1",    "1 2",   "5 -",
                                     "1e999",    "1e-999", "1e-310", "1e-305 um", "0x10 m", "1 /s/", "1 m/",
                                     "1 m^99",   "1 *m",   "1..2",   "5 m^",      "\xff"};
  for (const std::string& text : bad) EXPECT_THROW(parse_quantity(text, dimension::length), Error) << text;
}

TEST(Quantity, UnitNamesReadBack) {
  for (const Dimension& d : {dimension::length, dimension::velocity, dimension::acceleration, dimension::density,
                             dimension::force, dimension::viscosity, dimension::inertia, dimension::stiffness,
                             dimension::damping, dimension::angular_velocity, dimension::temperature})
    EXPECT_EQ(parse_quantity("3 " + unit_of(d), d), 3) << unit_of(d);
}

TEST(Nearest, CountsEditsAndSwaps) {
  EXPECT_EQ(edit_distance("size", "size"), 0);
  EXPECT_EQ(edit_distance("siez", "size"), 1);
  EXPECT_EQ(edit_distance("", "abc"), 3);
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3);
}

TEST(Nearest, NamesTheClosestOrNothing) {
  const std::vector<std::string> keys{"size", "material", "mix", "fill"};
  EXPECT_EQ(nearest("siez", keys), "size");
  EXPECT_EQ(nearest("materials", keys), "material");
  EXPECT_EQ(nearest("zzzzzz", keys), "");
}

}  // namespace
}  // namespace repose
