#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace curbstone {

/// Bytes of a file's beginning that tell all kinds.
inline constexpr std::size_t kFileKindBytes = 512;

/// What a file is that a user gave by mistake, from its first bytes, and what to do with it: "a file compressed by
/// gzip: unpack it first (gunzip)". Empty if they are of none of the kinds that are met beside logs and maps.
[[nodiscard]] std::string_view file_kind(std::span<const std::uint8_t> head);
/// The same of the file itself; empty, too, if it cannot be read. For regular files: a pipe would be waited for.
[[nodiscard]] std::string_view file_kind(const std::string& file);

}  // namespace curbstone
