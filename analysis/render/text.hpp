#pragma once
/// Text in pictures: DejaVu Sans, set by FreeType, embedded in the library.
#include <memory>
#include <string_view>

#include "analysis/render/image.hpp"
#include "core/math.hpp"

namespace repose {

/// Sets lines of text. Not shared between threads.
class Typesetter {
 public:
  Typesetter();
  ~Typesetter();
  Typesetter(const Typesetter&) = delete;
  Typesetter& operator=(const Typesetter&) = delete;

  /// Width of a line of UTF-8 text [pixels] at an em of `size` pixels.
  double width(std::string_view text, double size) const;
  /// Draws a line with its left end at x and its baseline at y, in an sRGB colour of channels in [0, 1].
  void draw(Image& image, double x, double y, std::string_view text, double size, const Vec3& colour) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Lays an sRGB colour over a pixel; outside the image nothing happens. `cover` in [0, 1].
void blend(Image& image, int x, int y, const Vec3& colour, double cover);

/// A filled rectangle with rounded corners, anti-aliased [pixels].
void fill_rounded(Image& image, double x, double y, double width, double height, double corner, const Vec3& colour,
                  double cover);

}  // namespace repose
