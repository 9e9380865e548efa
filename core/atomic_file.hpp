#pragma once
/// Files that are there whole or not at all, and the checksum that tells a damaged one.
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace repose {

/// Writes `bytes` and then `more` to `file`: aside (`file`.partial), fsync, rename, fsync of the folder. Durable when it returns. Throws
/// Error (Kind::simulation: what was written before is still good) with the reason of the system.
void write_durably(const std::filesystem::path& file, std::string_view bytes, std::string_view more = {});

/// The whole file. Throws Error if it cannot be read.
std::string read_bytes(const std::filesystem::path& file);

/// A 64-bit checksum against damage, not against malice. Never changes: it is stored in files.
///   h <- rotl(h xor w, 29) * 0x9E3779B97F4A7C15 over the 8-byte little-endian words w, the last one padded with zeros,
/// starting from the length; folded by h xor h >> 32.
std::uint64_t checksum(std::string_view bytes);

}  // namespace repose
