#include "analysis/render/image.hpp"

#include <cstdio>
// jpeglib.h needs size_t and FILE declared before it.
#include <jpeglib.h>
#include <png.h>

#include <algorithm>
#include <csetjmp>
#include <cstdlib>

#include "core/error.hpp"
#include "core/recording.hpp"

namespace repose {
namespace {

void check(const Image& image) {
  const bool positive = image.width > 0 && image.height > 0;
  if (!positive ||
      image.rgb.size() != 3 * static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height))
    throw Error("picture",
                "its array holds " + std::to_string(image.rgb.size()) + " bytes, but it says " +
                    std::to_string(image.width) + " x " + std::to_string(image.height) + " pixels",
                "give width * height * 3 bytes and a positive size");
}

void append(png_structp png, png_bytep data, png_size_t size) {
  static_cast<std::string*>(png_get_io_ptr(png))->append(reinterpret_cast<const char*>(data), size);
}

/// libpng and libjpeg report errors by a call that must not return. An exception may not pass through their C frames,
/// so both jump back.
struct JpegErrors {
  jpeg_error_mgr base;
  std::jmp_buf back;
};

void jump_back(j_common_ptr info) { std::longjmp(reinterpret_cast<JpegErrors*>(info->err)->back, 1); }

bool compress_png(const Image& image, std::string& bytes) {
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png ? png_create_info_struct(png) : nullptr;
  if (!info || setjmp(png_jmpbuf(png))) {
    png_destroy_write_struct(&png, &info);
    return false;
  }
  png_set_write_fn(png, &bytes, append, nullptr);
  png_set_IHDR(png, info, static_cast<png_uint_32>(image.width), static_cast<png_uint_32>(image.height), 8,
               PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_set_sRGB(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
  png_set_compression_level(png, 6);
  png_write_info(png, info);
  for (int y = 0; y < image.height; ++y)
    png_write_row(png, image.rgb.data() + 3 * static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width));
  png_write_end(png, nullptr);
  png_destroy_write_struct(&png, &info);
  return true;
}

bool compress_jpeg(const Image& image, int quality, unsigned char*& buffer, unsigned long& size) {
  jpeg_compress_struct jpeg{};
  JpegErrors errors;
  jpeg.err = jpeg_std_error(&errors.base);
  errors.base.error_exit = jump_back;
  if (setjmp(errors.back)) {
    jpeg_destroy_compress(&jpeg);
    return false;
  }
  jpeg_create_compress(&jpeg);
  jpeg_mem_dest(&jpeg, &buffer, &size);
  jpeg.image_width = static_cast<JDIMENSION>(image.width);
  jpeg.image_height = static_cast<JDIMENSION>(image.height);
  jpeg.input_components = 3;
  jpeg.in_color_space = JCS_RGB;
  jpeg_set_defaults(&jpeg);
  jpeg_set_quality(&jpeg, std::clamp(quality, 1, 100), TRUE);
  jpeg.optimize_coding = TRUE;
  jpeg_start_compress(&jpeg, TRUE);
  while (jpeg.next_scanline < jpeg.image_height) {
    JSAMPROW row =
        const_cast<JSAMPROW>(image.rgb.data()) + 3 * static_cast<std::size_t>(jpeg.next_scanline) * jpeg.image_width;
    jpeg_write_scanlines(&jpeg, &row, 1);
  }
  jpeg_finish_compress(&jpeg);
  jpeg_destroy_compress(&jpeg);
  return true;
}

}  // namespace

std::string encode_png(const Image& image) {
  check(image);
  std::string bytes;
  if (!compress_png(image, bytes)) throw Error("picture", "libpng could not encode it", "try a smaller picture");
  return bytes;
}

std::string encode_jpeg(const Image& image, int quality) {
  check(image);
  unsigned char* buffer = nullptr;
  unsigned long size = 0;
  const bool done = compress_jpeg(image, quality, buffer, size);
  std::string bytes = done ? std::string(reinterpret_cast<const char*>(buffer), size) : std::string();
  std::free(buffer);
  if (!done) throw Error("picture", "libjpeg could not encode it", "jPEG holds at most 65500 x 65500 pixels");
  return bytes;
}

void write_png(const std::filesystem::path& file, const Image& image) { write_atomically(file, encode_png(image)); }

}  // namespace repose
