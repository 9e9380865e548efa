#pragma once
/// A picture in memory, and as PNG or JPEG.
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace repose {

/// 8 bits per channel, sRGB, rows from the top, no padding: rgb[3 * (y * width + x) + channel].
struct Image {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;
};

/// The bytes of a PNG file. Throws Error if the image is empty or its array has another size than it says.
std::string encode_png(const Image& image);

/// The bytes of a JPEG file, quality 1 to 100.
std::string encode_jpeg(const Image& image, int quality = 88);

/// Writes a PNG atomically: aside, then renamed. Throws Error naming the file.
void write_png(const std::filesystem::path& file, const Image& image);

}  // namespace repose
