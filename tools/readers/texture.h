/// The pictures on the triangles of a mesh, and what colour they have over a piece of one.
///
/// A picture's pixels are checked by its header before it is decoded: those of all pictures of a file may take, at four
/// bytes each, 64 MB and 64 times what the pictures take as they are written. Decoding one has at most five times its
/// four bytes a pixel; 5.4 bytes a pixel are kept.
#pragma once

#include <map>

#include "readers/source.h"

namespace thimble::tools {

/// Colours are light, 0 to 1, where they are averaged or multiplied, and bytes as screens take them elsewhere.
double light_of(std::uint8_t byte);
std::uint8_t screen_byte(double light);

/// A decoded picture and smaller ones of it, each pixel the average of those that it stands for.
class Texture {
 public:
  struct Sample {
    std::array<double, 3> light{1, 1, 1};
    double alpha = 1;
  };
  /// A box of the picture, by its middle and half its sides: 0 to 1 is the picture once, v runs down.
  struct Box {
    double u = 0, v = 0;
    double half_u = 0, half_v = 0;
  };

  /// @param rgba  four bytes a pixel, `width_px` x `height_px` of them
  Texture(std::shared_ptr<const std::uint8_t> rgba, std::int32_t width_px, std::int32_t height_px);
  /// The average over a box of any size, as light, each pixel by the part of it that the box covers and by its
  /// alpha. Cost: at most 100 pixels.
  Sample average(const Box& box, Wrap wrap_u, Wrap wrap_v) const;

 private:
  struct Level {
    std::shared_ptr<const std::uint8_t> rgba;
    std::int32_t width = 0, height = 0;
  };
  static Sample average_at(const Level& level, const Box& box, Wrap wrap_u, Wrap wrap_v);

  std::vector<Level> levels_;  ///< each half as wide and high as the one before
};

/// The pictures that one file names, each decoded once.
class Textures {
 public:
  /// @param path  of the file that names them; empty: it has nothing beside it
  explicit Textures(std::string path) : path_(std::move(path)) {}

  /// A PNG, JPEG or WebP beside the file: by its name, or, where that leads nowhere, by what is behind its last slash.
  /// Null, and a fault for `add_notes`, where it is missing, damaged, too large or something else.
  /// @param is_opacity  its alpha is wanted alone, which is its grey where all of it is opaque
  /// @throws ShortageError  no descriptors or memory left to open it
  std::shared_ptr<const Texture> beside(const std::string& name, bool is_opacity = false);
  /// The same of bytes; `key` names them, in notes and when they come again.
  std::shared_ptr<const Texture> inside(const std::string& key, std::span<const std::uint8_t> encoded,
                                        bool is_opacity = false);
  /// A picture that cannot be had at all; or a whole sentence of it.
  void miss(const std::string& name, const std::string& reason);
  void fault(std::string sentence) { faults_.push_back(std::move(sentence)); }
  /// A sentence for each of the first pictures that could not be had, and one for the others.
  void add_notes(Notes& notes) const;

 private:
  std::string path_;
  std::map<std::pair<std::string, bool>, std::shared_ptr<const Texture>> known_;  ///< the bool: as opacity
  std::vector<std::string> faults_;
  std::uint64_t encoded_bytes_ = 0, pixel_bytes_ = 0;
};

}  // namespace thimble::tools
