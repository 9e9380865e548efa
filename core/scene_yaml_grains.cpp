#include <algorithm>
#include <cmath>
#include <fstream>

#include <fmt/format.h>

#include "core/error.hpp"
#include "core/scene_yaml_blocks.hpp"

namespace repose {
namespace {

const NumberRule length = positive(dimension::length);

// First column of a CSV file [m]; a first line that is not a number is a header.
std::vector<double> read_size_file(const YamlReader& reader, const std::filesystem::path& file) {
  std::ifstream in(file);
  if (!in || std::filesystem::is_directory(file))
    reader.fail(fmt::format("file {} cannot be read", file.string()), "name a CSV file relative to the scene's folder");
  std::vector<double> sizes;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    std::string cell = line.substr(0, line.find(','));
    while (!cell.empty() && (cell.back() == '\r' || cell.back() == ' ')) cell.pop_back();
    if (cell.empty()) continue;
    try {
      sizes.push_back(parse_quantity(cell, dimension::length));
    } catch (const Error& error) {
      if (number == 1) continue;
      reader.fail(fmt::format("{}:{}: {}", file.string(), number, error.problem()), "one size in metres per line");
    }
    if (!(sizes.back() > 0))
      reader.fail(fmt::format("{}:{}: a size of {} m", file.string(), number, sizes.back()), "sizes are positive");
  }
  if (sizes.empty()) reader.fail(fmt::format("file {} holds no sizes", file.string()), "one size in metres per line");
  return sizes;
}

TableSize read_table(const YamlReader& reader, const std::filesystem::path& folder) {
  if (reader.node().kind == YamlNode::Kind::scalar) return {read_size_file(reader, folder / reader.text())};
  TableSize table;
  for (const YamlReader& item : reader.items()) table.values.push_back(item.number(length));
  if (table.values.empty()) reader.fail("an empty list of sizes", "list sizes, or name a CSV file");
  return table;
}

void read_normal(const YamlReader& size, SizeDistribution& result) {
  const YamlReader reader = size.at("normal");
  const std::vector<double> values = reader.numbers(non_negative(dimension::length), 2);
  if (!(values[0] > 0)) reader.fail("the mean size is not positive", "write `normal: [mean, sd]`");
  if (!(values[1] > 0)) reader.fail("the standard deviation is not positive", "for equal grains write `size: 58 um`");
  if (!size.has("range") && values[0] < 5 * values[1])
    size.fail("a normal law this wide reaches sizes below zero and needs limits", "add `range: [smallest, largest]`");
  result.law = NormalSize{values[0], values[1]};
}

void read_lognormal(const YamlReader& size, SizeDistribution& result) {
  const std::vector<YamlReader> items = size.at("lognormal").items();
  if (items.size() != 2)
    size.at("lognormal").fail("expected two values", "write `lognormal: [median, sd of ln(size)]`");
  result.law = LogNormalSize{items[0].number(length), items[1].number(positive(dimension::none))};
}

// A range that the law practically never meets would make rejection sampling hang.
void check_range_is_met(const YamlReader& range, const SizeDistribution& size) {
  const auto refuse = [&](const std::string& what) {
    range.fail(what + " lies outside this range", "widen the range, or correct the law (a missing unit?)");
  };
  const auto outside = [&](double lower, double upper) { return upper < size.lower || lower > size.upper; };
  if (const auto* fixed = std::get_if<FixedSize>(&size.law); fixed && outside(fixed->value, fixed->value))
    refuse("the fixed size");
  if (const auto* law = std::get_if<NormalSize>(&size.law);
      law && outside(law->mean - 3 * law->sd, law->mean + 3 * law->sd))
    refuse("the law (mean plus and minus three sd)");
  if (const auto* law = std::get_if<LogNormalSize>(&size.law);
      law && outside(law->median * std::exp(-3 * law->log_sd), law->median * std::exp(3 * law->log_sd)))
    refuse("the law (median within three sd of the logarithm)");
  if (const auto* table = std::get_if<TableSize>(&size.law);
      table &&
      std::none_of(table->values.begin(), table->values.end(), [&](double value) { return !outside(value, value); }))
    refuse("every size of the table");
}

SizeDistribution read_size(const YamlReader& reader, const std::filesystem::path& folder) {
  SizeDistribution size;
  if (reader.node().kind == YamlNode::Kind::scalar) {
    size.law = FixedSize{reader.number(length)};
    return size;
  }
  reader.only({"fixed", "normal", "lognormal", "table", "range", "by"});
  int laws = 0;
  for (const char* law : {"fixed", "normal", "lognormal", "table"}) laws += reader.has(law) ? 1 : 0;
  if (laws != 1)
    reader.fail(
        laws == 0 ? "no size law" : "more than one size law",
        "give one of fixed: d; normal: [mean, sd]; lognormal: [median, sd of ln]; table: [d, ...] or a CSV file");
  if (reader.has("fixed")) size.law = FixedSize{reader.at("fixed").number(length)};
  if (reader.has("normal")) read_normal(reader, size);
  if (reader.has("lognormal")) read_lognormal(reader, size);
  if (reader.has("table")) size.law = read_table(reader.at("table"), folder);
  if (reader.has("by")) size.by_volume = reader.at("by").choice({"number", "volume"}) == 1;
  if (reader.has("range")) {
    const YamlReader range = reader.at("range");
    const std::vector<double> limits = range.numbers(length, 2);
    size.lower = limits[0];
    size.upper = limits[1];
    if (!(size.lower < size.upper))
      range.fail("the smallest size is not below the largest", "write `[smallest, largest]`");
    check_range_is_met(range, size);
  }
  return size;
}

FillRegion read_fill(const YamlReader& reader) {
  reader.only({"box", "cylinder", "frustum", "grow"});
  FillRegion fill;
  reader.read("grow", fill.grow);
  const int regions = (reader.has("box") ? 1 : 0) + (reader.has("cylinder") ? 1 : 0) + (reader.has("frustum") ? 1 : 0);
  if (regions != 1)
    reader.fail(regions == 0 ? "no region" : "more than one region",
                "give one of box: {lower, upper}; cylinder: {base, radius, height}; frustum: {base, radius_bottom, "
                "radius_top, height}");
  if (reader.has("box")) {
    const YamlReader box = reader.at("box");
    box.only({"lower", "upper"});
    fill.kind = FillRegion::Kind::box;
    box.require("lower", fill.lower, any(dimension::length));
    box.require("upper", fill.upper, any(dimension::length));
    if (!((fill.upper - fill.lower).minCoeff() > 0)) box.fail("has no volume", "each of `upper` must exceed `lower`");
    return fill;
  }
  fill.kind = FillRegion::Kind::frustum;
  const bool is_cylinder = reader.has("cylinder");
  const YamlReader region = reader.at(is_cylinder ? "cylinder" : "frustum");
  if (is_cylinder) {
    region.only({"base", "radius", "height"});
    region.require("radius", fill.radius_bottom, length);
    fill.radius_top = fill.radius_bottom;
  } else {
    region.only({"base", "radius_bottom", "radius_top", "height"});
    region.require("radius_bottom", fill.radius_bottom, length);
    region.require("radius_top", fill.radius_top, length);
  }
  region.require("base", fill.base, any(dimension::length));
  region.require("height", fill.height, length);
  return fill;
}

std::map<std::string, double> read_mix(const YamlReader& reader) {
  reader.only(grain_shape_names());
  std::map<std::string, double> mix;
  double sum = 0;
  for (const auto& [shape, share] : reader.named()) sum += mix[shape] = share.number(non_negative(dimension::none));
  if (!(sum > 0))
    reader.fail("the shares add up to nothing", "write e.g. `{sphere: 1, twin: 1}`: shares, in any scale");
  return mix;
}

GrainPopulation read_population(const std::string& name, const YamlReader& reader, const std::filesystem::path& folder,
                                const Scene& scene) {
  reader.only({"material", "count", "mass", "mix", "mix_by", "aspect", "size", "fill", "velocity"});
  GrainPopulation grains;
  grains.name = name;
  grains.material = read_material_name(reader, scene);
  if (reader.has("count") == reader.has("mass"))
    reader.fail(reader.has("count") ? "`count` and `mass` are both given" : "how many grains?",
                "give exactly one of `count: 10000` and `mass: 10 mg`");
  if (reader.has("count")) grains.count = reader.at("count").count();
  if (reader.has("mass")) grains.total_mass = reader.at("mass").number(positive(dimension::mass));
  grains.mix = reader.has("mix") ? read_mix(reader.at("mix")) : std::map<std::string, double>{{"sphere", 1}};
  if (reader.has("mix_by")) grains.mix_by_mass = reader.at("mix_by").choice({"number", "mass"}) == 1;
  reader.read("aspect", grains.aspect, positive(dimension::none));
  for (const auto& [shape, share] : grains.mix) {
    try {
      make_grain_shape(shape, scene.proportions.with_aspect(grains.aspect));
    } catch (const Error& error) {
      reader.at("aspect").fail(fmt::format("makes `{}` impossible: {}", shape, error.problem()), error.remedy());
    }
  }
  grains.size = read_size(reader.at("size"), folder);
  grains.fill = read_fill(reader.at("fill"));
  reader.read("velocity", grains.velocity, any(dimension::velocity));
  return grains;
}

}  // namespace

void read_grains(const YamlReader& block, const std::filesystem::path& folder, Scene& scene) {
  for (const auto& [name, reader] : block.named()) scene.grains.push_back(read_population(name, reader, folder, scene));
  std::sort(scene.grains.begin(), scene.grains.end(),
            [](const GrainPopulation& a, const GrainPopulation& b) { return a.name < b.name; });
}

}  // namespace repose
