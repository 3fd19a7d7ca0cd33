#include "output/voxel_file.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <initializer_list>
#include <map>
#include <string>
#include <vector>

#include "output/hit_rows.h"
#include "output/units.h"
#include "readers/oct.h"
#include "readers/text.h"

namespace thimble::tools {
namespace {

// What was written so far is handed on in pieces of about so many bytes.
constexpr std::size_t kPieceBytes = 1 << 16;

// Calls visit(voxel, material) for every voxel, and `progress` now and then.
template <class Visit>
void for_each_voxel(const CompactTree& tree, const Progress& progress, const Visit& visit) {
  ProgressMeter meter(progress, tree.voxel_count());
  std::uint64_t done = 0;
  walk_blocks(tree, [&](const Vec3i& corner, int level, std::uint8_t material) {
    for_voxels(corner, level, [&](std::int32_t x, std::int32_t y, std::int32_t z) {
      visit(Vec3i{x, y, z}, material);
      meter.at(++done);
    });
  });
}

class Writer {
 public:
  explicit Writer(OutputFile* file) : file_(file) {}
  void text(std::string_view words) {
    if (words.size() >= kPieceBytes) {  // not copied: an array may be as large as the memory
      end();
      file_->write(words);
      return;
    }
    bytes_.append(words);
    if (bytes_.size() >= kPieceBytes) {
      end();
    }
  }
  void little(std::uint32_t value, std::size_t count) {
    append_little(&bytes_, value, count);
    text({});
  }
  void color(const Rgb& color) {
    little(color.r, 1);
    little(color.g, 1);
    little(color.b, 1);
  }
  void end() {
    file_->write(bytes_);
    bytes_.clear();
  }

 private:
  OutputFile* file_;
  std::string bytes_;
};

void write_ply(Writer* to, const CompactTree& tree, const Palette& palette, bool has_colors,
               const Progress& progress) {
  to->text(
      "ply\nformat binary_little_endian 1.0\ncomment voxel indices; thimble reads them with --as-voxels\n");
  to->text("element vertex " + std::to_string(tree.voxel_count()) + "\n");
  to->text("property short x\nproperty short y\nproperty short z\n");
  if (has_colors) {
    to->text("property uchar red\nproperty uchar green\nproperty uchar blue\n");
  }
  to->text("end_header\n");
  for_each_voxel(tree, progress, [&](const Vec3i& voxel, std::uint8_t material) {
    for (int axis = 0; axis < 3; ++axis) {
      to->little(static_cast<std::uint32_t>(voxel[axis]), 2);
    }
    if (has_colors) {
      to->color(palette[material].color);
    }
  });
}

void write_csv(Writer* to, const CompactTree& tree, const Palette& palette, bool has_colors,
               const Progress& progress) {
  std::array<std::string, 256> colors;
  if (has_colors) {
    const UsedMaterials used = used_materials(tree);
    int highest = 0;
    for (std::size_t i = 0; i < palette.size(); ++i) {
      const Rgb& color = palette[i].color;
      highest = std::max(highest, used.is[i] ? std::max({color.r, color.g, color.b}) : 0);
    }
    const auto word = [&](std::uint8_t part) {
      return std::string(",") + (highest > 1 ? std::to_string(part) : part == 0 ? "0" : "0.0039215686");
    };
    for (std::size_t i = 0; i < palette.size(); ++i) {
      const Rgb& color = palette[i].color;
      colors[i] = word(color.r) + word(color.g) + word(color.b);
    }
  }
  to->text(has_colors ? "x,y,z,r,g,b\n" : "x,y,z\n");
  for_each_voxel(tree, progress, [&](const Vec3i& voxel, std::uint8_t material) {
    to->text(concat(voxel.x, ",", voxel.y, ",", voxel.z, colors[material], "\n"));
  });
}

void write_npy(Writer* to, const CompactTree& tree, const Palette& palette, bool has_colors,
               const Progress& progress) {
  const Vec3i size = tree.bounds().high;
  const std::size_t parts = has_colors ? 4 : 1;
  const auto x_size = static_cast<std::uint64_t>(size.x);
  const auto y_size = static_cast<std::uint64_t>(size.y);
  const auto z_size = static_cast<std::uint64_t>(size.z);
  const std::uint64_t bytes = x_size * y_size * z_size * parts;
  fail_if(bytes > kMostArrayBytes, "an array of ", size.x, " x ", size.y, " x ", size.z, " voxels takes ",
          grouped(bytes), " bytes, ", grouped(kMostArrayBytes),
          " are the most; a .ply lists what is solid alone");
  to->text(npy_header("'|u1'", concat(size.x, ", ", size.y, ", ", size.z, has_colors ? ", 4" : "")));
  std::vector<char> array(bytes);
  for_each_voxel(tree, progress, [&](const Vec3i& voxel, std::uint8_t material) {
    char* const at =
        array.data() +
        ((static_cast<std::uint64_t>(voxel.x) * y_size + static_cast<std::uint64_t>(voxel.y)) * z_size +
         static_cast<std::uint64_t>(voxel.z)) *
            parts;
    if (!has_colors) {
      *at = 1;
      return;
    }
    const Rgb& color = palette[material].color;
    at[0] = static_cast<char>(color.r);
    at[1] = static_cast<char>(color.g);
    at[2] = static_cast<char>(color.b);
    at[3] = static_cast<char>(255);
  });
  to->text({array.data(), array.size()});
}

// ---- MagicaVoxel.

constexpr int kModelBits = 8;  // a model has at most 256 voxels a side

// The colours that are used, at most 255: their index in the file, from 1 on, for each material. When there are 256,
// the two that are nearest share one.
struct VoxColors {
  explicit VoxColors(const CompactTree& tree, const Palette& palette) {
    const UsedMaterials used = used_materials(tree);
    for (std::size_t i = 0; i < palette.size(); ++i) {
      if (!used.is[i]) {
        continue;
      }
      const Rgb& color = palette[i].color;
      auto found = std::find(colors.begin(), colors.end(), color);
      if (found == colors.end() && colors.size() == 255) {
        found = std::min_element(colors.begin(), colors.end(), [&](const Rgb& a, const Rgb& b) {
          return distance(a, color) < distance(b, color);
        });
      } else if (found == colors.end()) {
        found = colors.insert(colors.end(), color);
      }
      index[i] = static_cast<std::uint8_t>(found - colors.begin() + 1);
    }
  }
  static int distance(const Rgb& a, const Rgb& b) {
    const int r = a.r - b.r;
    const int g = a.g - b.g;
    const int blue = a.b - b.b;
    return r * r + g * g + blue * blue;
  }
  std::vector<Rgb> colors;
  std::array<std::uint8_t, 256> index{};
};

struct VoxModel {
  Vec3i size;
  std::vector<std::uint8_t> voxels;  // x, y, z, colour
};

void begin_chunk(Writer* to, std::string_view name, std::size_t bytes) {
  to->text(name);
  to->little(static_cast<std::uint32_t>(bytes), 4);
  to->little(0, 4);
}

std::size_t model_bytes(const VoxModel& model) {
  return (12 + 12) + (12 + 4 + model.voxels.size());
}

void write_model(Writer* to, const VoxModel& model) {
  begin_chunk(to, "SIZE", 12);
  for (int axis = 0; axis < 3; ++axis) {
    to->little(static_cast<std::uint32_t>(model.size[axis]), 4);
  }
  begin_chunk(to, "XYZI", 4 + model.voxels.size());
  to->little(static_cast<std::uint32_t>(model.voxels.size() / 4), 4);
  to->text({reinterpret_cast<const char*>(model.voxels.data()), model.voxels.size()});
}

// The chunks of the scene graph: a root, a group, and for each model its place and itself.
std::string scene_graph(const std::map<std::array<std::int32_t, 3>, VoxModel>& models) {
  std::string bytes;
  const auto words_of = [](std::initializer_list<std::uint32_t> words) {
    std::string content;
    for (const std::uint32_t word : words) {
      append_little(&content, word);
    }
    return content;
  };
  const auto sized = [&](const std::string& content) {
    return words_of({static_cast<std::uint32_t>(content.size())}) + content;
  };
  const auto add = [&](const char* name, const std::string& content) {
    bytes += name + words_of({static_cast<std::uint32_t>(content.size()), 0}) + content;
  };
  // A transformation of `child`, in no layer, with one frame.
  const auto transform = [&](std::uint32_t id, std::uint32_t child, const std::string& translation) {
    const std::string frame =
        translation.empty() ? words_of({0}) : words_of({1}) + sized("_t") + sized(translation);
    add("nTRN", words_of({id, 0, child, UINT32_MAX, UINT32_MAX, 1}) + frame);
  };
  const auto count = static_cast<std::uint32_t>(models.size());
  transform(0, 1, "");
  std::string group = words_of({1, 0, count});
  for (std::uint32_t i = 0; i < count; ++i) {
    append_little(&group, 2 + 2 * i);
  }
  add("nGRP", group);
  std::uint32_t number = 0;
  for (const auto& [cell, model] : models) {
    // A model's middle is what is placed.
    std::string translation;
    for (int axis = 0; axis < 3; ++axis) {
      const std::int32_t corner = cell[static_cast<std::size_t>(axis)] * (1 << kModelBits);
      translation += (axis == 0 ? "" : " ") + std::to_string(corner + model.size[axis] / 2);
    }
    transform(2 + 2 * number, 3 + 2 * number, translation);
    add("nSHP", words_of({3 + 2 * number, 0, 1, number, 0}));
    ++number;
  }
  return bytes;
}

void write_vox(Writer* to, const CompactTree& tree, const Palette& palette, const Progress& progress) {
  const VoxColors colors(tree, palette);
  std::map<std::array<std::int32_t, 3>, VoxModel> models;
  const Vec3i all = tree.bounds().high;
  const auto model_at = [&](const Vec3i& voxel) -> VoxModel& {
    const std::array cell{voxel.x >> kModelBits, voxel.y >> kModelBits, voxel.z >> kModelBits};
    VoxModel& model = models[cell];
    if (model.size.x == 0) {
      for (int axis = 0; axis < 3; ++axis) {
        model.size[axis] =
            std::min(all[axis] - cell[static_cast<std::size_t>(axis)] * (1 << kModelBits), 1 << kModelBits);
      }
    }
    return model;
  };
  for_each_voxel(tree, progress, [&](const Vec3i& voxel, std::uint8_t material) {
    const auto low = [](std::int32_t index) { return static_cast<std::uint8_t>(index & 255); };
    const std::array<std::uint8_t, 4> entry{low(voxel.x), low(voxel.y), low(voxel.z), colors.index[material]};
    std::vector<std::uint8_t>& voxels = model_at(voxel).voxels;
    voxels.insert(voxels.end(), entry.begin(), entry.end());
  });
  const std::string graph = models.size() == 1 ? std::string() : scene_graph(models);
  constexpr std::size_t kPaletteBytes = 12 + 1024;
  std::uint64_t bytes = graph.size() + kPaletteBytes;
  for (const auto& [cell, model] : models) {
    bytes += model_bytes(model);
  }
  fail_if(bytes > INT32_MAX, "as .vox this takes ", grouped(bytes),
          " bytes, more than its chunks can count; .ply can");
  to->text("VOX ");
  to->little(models.size() == 1 ? 150 : 200, 4);
  to->text("MAIN");
  to->little(0, 4);
  to->little(static_cast<std::uint32_t>(bytes), 4);
  for (const auto& [cell, model] : models) {
    write_model(to, model);
  }
  to->text(graph);
  begin_chunk(to, "RGBA", 1024);
  for (std::size_t i = 0; i < 256; ++i) {
    to->color(i < colors.colors.size() ? colors.colors[i] : Rgb{0, 0, 0});
    to->little(255, 1);
  }
}

}  // namespace

std::optional<VoxelFormat> voxel_format(std::string_view path) {
  return kind_by_ending<VoxelFormat>(path, {".vox", ".npy", ".ply", ".csv"});
}

void write_voxels(OutputFile* file, VoxelFormat format, const CompactTree& tree, const Palette& palette,
                  bool has_colors, const Progress& progress) {
  Writer to(file);
  if (format == VoxelFormat::kVox) {
    write_vox(&to, tree, palette, progress);
  } else {
    constexpr std::array kWriters{write_npy, write_ply, write_csv};  // in the order of `VoxelFormat`
    kWriters[static_cast<std::size_t>(format) - 1](&to, tree, palette, has_colors, progress);
  }
  to.end();
}

}  // namespace thimble::tools
