#include "analysis/render/text.hpp"

#include <ft2build.h>
#include FT_FREETYPE_H
#include FT_OUTLINE_H

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/error.hpp"

namespace repose {
namespace embedded {
std::string_view font();
}

namespace {

/// The next code point of well-formed UTF-8; a stray byte stands for itself.
std::uint32_t next_code_point(std::string_view& text) {
  const auto byte = [&](std::size_t i) { return static_cast<std::uint32_t>(static_cast<unsigned char>(text[i])); };
  std::size_t length = 1;
  std::uint32_t code = byte(0);
  if (code >= 0xf0)
    length = 4, code &= 0x07U;
  else if (code >= 0xe0)
    length = 3, code &= 0x0fU;
  else if (code >= 0xc0)
    length = 2, code &= 0x1fU;
  if (length > text.size()) length = 1;
  for (std::size_t i = 1; i < length; ++i) code = (code << 6U) | (byte(i) & 0x3fU);
  text.remove_prefix(length);
  return code;
}

}  // namespace

struct Typesetter::Impl {
  FT_Library library = nullptr;
  FT_Face face = nullptr;

  ~Impl() {
    if (face) FT_Done_Face(face);
    if (library) FT_Done_FreeType(library);
  }
  /// Calls use(slot, x) for each glyph, x being its pen position in pixels; returns the width of the line.
  template <class Use>
  double each_glyph(std::string_view text, double size, FT_Int32 flags, Use&& use) const {
    FT_Set_Char_Size(face, 0, static_cast<FT_F26Dot6>(std::lround(size * 64)), 72, 72);
    double pen = 0;
    while (!text.empty()) {
      const std::uint32_t code = next_code_point(text);
      if (FT_Load_Char(face, code, flags) != 0) continue;
      use(face->glyph, pen);
      pen += static_cast<double>(face->glyph->linearHoriAdvance) / 65536.0;
    }
    return pen;
  }
};

Typesetter::Typesetter() : impl_(std::make_unique<Impl>()) {
  const std::string_view font = embedded::font();
  if (FT_Init_FreeType(&impl_->library) != 0 ||
      FT_New_Memory_Face(impl_->library, reinterpret_cast<const FT_Byte*>(font.data()),
                         static_cast<FT_Long>(font.size()), 0, &impl_->face) != 0)
    throw Error("picture", "FreeType could not read the embedded font",
                "build again with the package fonts-dejavu-core");
}

Typesetter::~Typesetter() = default;

double Typesetter::width(std::string_view text, double size) const {
  return impl_->each_glyph(text, size, FT_LOAD_NO_HINTING, [](FT_GlyphSlot, double) {});
}

void Typesetter::draw(Image& image, double x, double y, std::string_view text, double size, const Vec3& colour) const {
  const auto stamp = [&](FT_GlyphSlot glyph, double pen) {
    // The outline is moved by the fraction of a pixel, so that letters keep their spacing.
    const double place = x + pen, whole = std::floor(place);
    FT_Outline_Translate(&glyph->outline, std::lround((place - whole) * 64), 0);
    if (FT_Render_Glyph(glyph, FT_RENDER_MODE_NORMAL) != 0) return;
    const FT_Bitmap& bitmap = glyph->bitmap;
    for (unsigned row = 0; row < bitmap.rows; ++row)
      for (unsigned column = 0; column < bitmap.width; ++column)
        blend(image, static_cast<int>(whole) + glyph->bitmap_left + static_cast<int>(column),
              static_cast<int>(std::lround(y)) - glyph->bitmap_top + static_cast<int>(row), colour,
              bitmap.buffer[row * static_cast<unsigned>(bitmap.pitch) + column] / 255.0);
  };
  impl_->each_glyph(text, size, FT_LOAD_NO_HINTING | FT_LOAD_NO_BITMAP, stamp);
}

void blend(Image& image, int x, int y, const Vec3& colour, double cover) {
  if (x < 0 || y < 0 || x >= image.width || y >= image.height || cover <= 0) return;
  std::uint8_t* pixel = &image.rgb[3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
                                        static_cast<std::size_t>(x))];
  for (int i = 0; i < 3; ++i)
    pixel[i] = static_cast<std::uint8_t>(std::lround(pixel[i] + cover * (255 * colour[i] - pixel[i])));
}

void fill_rounded(Image& image, double x, double y, double width, double height, double corner, const Vec3& colour,
                  double cover) {
  corner = std::max(corner, 0.5);  // a sharper one would fade the inside too
  const double half_x = width / 2, half_y = height / 2, centre_x = x + half_x, centre_y = y + half_y;
  for (int row = static_cast<int>(y) - 1; row <= static_cast<int>(y + height) + 1; ++row)
    for (int column = static_cast<int>(x) - 1; column <= static_cast<int>(x + width) + 1; ++column) {
      const double dx = std::max(std::abs(column + 0.5 - centre_x) - half_x + corner, 0.0);
      const double dy = std::max(std::abs(row + 0.5 - centre_y) - half_y + corner, 0.0);
      blend(image, column, row, colour, cover * std::clamp(corner - std::hypot(dx, dy) + 0.5, 0.0, 1.0));
    }
}

}  // namespace repose
