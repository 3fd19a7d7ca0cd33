/// @file gltf_picture.h
/// The picture of a material. Internal to the glTF reader.
#ifndef THIMBLE_TOOLS_READERS_GLTF_PICTURE_H
#define THIMBLE_TOOLS_READERS_GLTF_PICTURE_H

#include <cstdint>
#include <memory>
#include <span>

#include "readers/source.h"

namespace thimble::tools {

/// A PNG or JPEG, decoded. Empty where it is neither, damaged, or larger than allowed.
class GltfPicture {
 public:
  GltfPicture() = default;
  /// @param limit_bytes  what decoding may take, at about six bytes a pixel
  GltfPicture(std::span<const std::uint8_t> encoded, std::uint64_t limit_bytes);

  bool is_empty() const { return pixels_ == nullptr; }
  /// The pixel at u, v, which repeat from 0 to 1; v runs down. White where it is empty.
  Rgb at(double u, double v) const;

 private:
  std::shared_ptr<const std::uint8_t> pixels_;
  std::int32_t width_ = 0, height_ = 0;
};

}  // namespace thimble::tools

#endif
