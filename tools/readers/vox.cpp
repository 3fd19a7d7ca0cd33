// MagicaVoxel `.vox` files, versions 150 and 200.
//
// What is read: all models (SIZE, XYZI), the palette (RGBA, or MagicaVoxel's default one), materials (MATT,
// MATL), layers (LAYR) and the scene graph (nTRN, nGRP, nSHP) with translations, rotations and mirrors,
// shared and nested groups, hidden nodes and hidden layers. Of an animation one frame is taken, the first
// by default. With a scene graph a node is as its key with the greatest `_f` up to the frame
// says, and holds still until the next one; in a file without one, several models only ever are frames. What
// is placed stays where it is from frame to frame: the lowest corner is that of all frames together. IMAP
// orders the colours of the editor's palette window and nothing else, so colours do not depend on it; it is
// skipped as cameras, lights, notes and unknown chunks are.
//
// Conventions: the axes are the file's, z up, right-handed. A model of size s turns about the lattice point
// floor(s / 2), which its node's translation places; voxels turn by their centres, as MagicaVoxel does.
// Colour index c of a voxel is entry c - 1 of RGBA and `palette()[c]` here; a voxel of index 0 is empty
// space and is left out.
//
// Source of the format: ephtracy, "MagicaVoxel .vox File Format" and its extension.
#include "readers/formats.h"

#include <deque>
#include <limits>
#include <set>
#include <tuple>

#include "readers/vox_parts.h"

namespace thimble::tools {

namespace {

/// Longest side of one model: XYZI holds a position in a byte an axis.
constexpr std::uint32_t kVoxModelSideLimit = 256;
/// Most models placed in a scene. Groups may be shared, so a few bytes can ask for 2^n of them.
constexpr std::uint32_t kVoxInstanceLimit = 65536;
/// Most nodes entered to find how far an animation reaches.
constexpr std::uint64_t kVoxAnimationLimit = std::uint64_t{1} << 22;
/// Most voxels in all placed models together: what one call of `for_each` may have to do.
constexpr std::uint64_t kVoxPlacedVoxelLimit = std::uint64_t{1} << 31;
constexpr std::size_t kVoxelBytes = 4;  // x, y, z, colour index

/// One SIZE and XYZI or TDCZ pair.
struct Model {
  std::array<std::uint32_t, 3> size{};
  std::span<const std::uint8_t> voxels;
  bool empty = true;  ///< no voxel with a colour
};

/// A model placed in the world: world[i] = sign[i] * voxel[axis[i]] + offset[i].
struct Instance {
  std::uint32_t model = 0;
  std::array<std::int32_t, 3> offset{};
  std::array<std::uint8_t, 3> axis{};
  std::array<std::int8_t, 3> sign{};

  friend bool operator<(const Instance& a, const Instance& b) {
    return std::tie(a.model, a.offset, a.axis, a.sign) < std::tie(b.model, b.offset, b.axis, b.sign);
  }
};

/// Folds the model's pivot into the transform. The centre of voxel v lies at v + 1/2 - pivot; turned to the
/// negative side it is the centre of the voxel one below the mirrored lattice point.
Instance make_instance(std::uint32_t number, const Model& model, const VoxTransform& transform) {
  Instance instance{number, transform.translation, transform.axis, transform.sign};
  for (std::size_t i = 0; i < 3; ++i) {
    const auto pivot = static_cast<std::int32_t>(model.size[transform.axis[i]] / 2);
    instance.offset[i] += transform.sign[i] > 0 ? -pivot : pivot - 1;
  }
  return instance;
}

// Colours and materials: RGBA, MATT (version 150) and MATL (version 200).

/// RGBA: 256 times r, g, b, alpha. The first is colour index 1; the last stands for index 0, the empty voxel,
/// and is ignored. Where there are fewer, the others stay as they are. Changes colours and alpha only, so
/// that the order of RGBA and MATL does not matter.
void read_rgba(ByteReader& chunk, Palette& palette) {
  for (std::size_t index = 1; index < palette.size() && (index == 1 || chunk.remaining() != 0); ++index) {
    Material& material = palette[index];
    material.color.r = chunk.u8();
    material.color.g = chunk.u8();
    material.color.b = chunk.u8();
    material.alpha = chunk.u8();
  }
}

/// A number of a material: its names in MATL, of which the newer counts before the older, and its bit in MATT.
struct Property {
  std::string_view name, old_name;
  double Material::*value;
  double least, most;
  unsigned bit = 7;  ///< means nothing
};
constexpr double kUnbounded = std::numeric_limits<double>::max();
constexpr std::string_view kIorExcess = "_ior";  // what exceeds 1, as in MATT
constexpr std::array<Property, 9> kProperties{{{"_weight", "", &Material::weight, 0, 1},
                                               {"_rough", "", &Material::roughness, 0, 1, 1},
                                               {"_ri", kIorExcess, &Material::ior, 1, kUnbounded, 3},
                                               {"_att", "", &Material::attenuation, 0, kUnbounded, 4},
                                               {"_flux", "", &Material::flux, 0, kUnbounded, 5},
                                               {"_emit", "", &Material::emission, 0, 1, 6},
                                               {"_density", "_d", &Material::density, 0, kUnbounded},
                                               {"_metal", "", &Material::metalness, 0, 1},
                                               {"_trans", "_alpha", &Material::transparency, 0, 1}}};

/// NaN leaves the default.
void set_property(const Property& property, bool is_newer, double value, Material& material) {
  value += !is_newer && property.old_name == kIorExcess ? 1 : 0;
  if (!std::isnan(value)) {
    material.*property.value = std::clamp(value, property.least, property.most);
  }
}

/// Material ids are colour indices; newer files count 1 to 256, older ones 0 to 255, and both ends mean the
/// unused entry.
Material& material_of(std::int32_t id, const ByteReader& chunk, Palette& palette) {
  chunk.fail_if(id < 0 || id > 256, "material ", id, " is outside 0 to 256");
  return palette[static_cast<std::size_t>(id) & 0xff];
}

/// MATT, obsolete since version 0.99: an id, a kind, a weight, a bit mask and one float a bit that is set.
void read_matt(ByteReader& chunk, Palette& palette) {
  Material& material = material_of(chunk.i32(), chunk, palette);
  constexpr std::array kKinds{SurfaceKind::kDiffuse, SurfaceKind::kMetal, SurfaceKind::kGlass,
                              SurfaceKind::kEmit};
  const std::uint32_t kind = chunk.u32();
  if (kind < kKinds.size()) {
    material.kind = kKinds[kind];
  }
  set_property(kProperties[0], true, static_cast<double>(chunk.f32()), material);
  const std::uint32_t present = chunk.u32();
  // Bits: 0 plastic, 1 roughness, 2 specular, 3 index of refraction, 4 attenuation, 5 power, 6 glow, 7 "power
  // is total". Only bit 7 comes with or without a value, and being last it does not move the others.
  for (unsigned bit = 0; bit < 7; ++bit) {
    const double value = (present >> bit & 1u) != 0 ? static_cast<double>(chunk.f32()) : std::nan("");
    for (const Property& property : kProperties) {
      if (property.bit == bit) {
        set_property(property, false, value, material);
      }
    }
  }
}

/// MATL: an id and a dictionary of texts. A value that is no number, or is NaN, leaves the default.
void read_matl(ByteReader& chunk, Palette& palette) {
  Material& material = material_of(chunk.i32(), chunk, palette);
  std::array<bool, kProperties.size()> has_newer{};
  vox_dictionary(chunk, [&](std::string_view key, std::string_view text) {
    if (key == "_type") {
      material.kind = text == "_metal"   ? SurfaceKind::kMetal
                      : text == "_glass" ? SurfaceKind::kGlass
                      : text == "_emit"  ? SurfaceKind::kEmit
                      : text == "_media" ? SurfaceKind::kMedia
                                         : SurfaceKind::kDiffuse;
    }
    const double value = number_in<double>(text).value_or(std::nan(""));
    for (std::size_t i = 0; i < kProperties.size() && !key.empty() && !std::isnan(value); ++i) {
      const bool is_newer = key == kProperties[i].name;
      if (is_newer || (key == kProperties[i].old_name && !has_newer[i])) {
        set_property(kProperties[i], is_newer, value, material);
        has_newer[i] = has_newer[i] || is_newer;
      }
    }
  });
}

struct ChunkHead {
  std::string_view id;
  std::uint64_t offset;
  std::uint32_t content_bytes;
  std::uint32_t children_bytes;
};

/// Reads the twelve bytes before a chunk and checks that what they announce is there.
ChunkHead read_head(ByteReader& reader) {
  ChunkHead head{};
  head.offset = reader.offset();
  head.id = reader.text(4);
  head.content_bytes = reader.u32();
  head.children_bytes = reader.u32();
  const std::uint64_t announced = std::uint64_t{head.content_bytes} + head.children_bytes;
  fail_if(announced > reader.remaining(), vox_place(head.id, head.offset), ": ", announced,
          " bytes are announced and ", reader.remaining(), " are there");
  return head;
}

class VoxFile final : public VoxelModel {
 public:
  VoxFile(SharedBytes file, const Progress& progress, std::optional<std::uint32_t> frame)
      : file_(std::move(file)), frame_(frame) {
    ProgressMeter meter(progress, file_.bytes.size());
    read_chunks(meter);
    place_models();
  }

  void for_each(const Visit& visit) const override { visit_placed(instances_, visit); }
  void for_each_in_frames(const Visit& visit) const override { visit_placed(in_frames_, visit); }
  std::array<std::int32_t, 3> size() const override {
    // At most 2^25 + 512 apart, by the limit on translations.
    const auto side = [this](std::size_t i) { return box_.empty ? 0 : box_.high[i] - box_.low[i] + 1; };
    return {side(0), side(1), side(2)};
  }
  const Palette& palette() const override { return palette_; }
  std::uint32_t frames() const override { return frames_; }

 private:
  template <class Instances>
  void visit_placed(const Instances& instances, const Visit& visit) const {
    for (const Instance& instance : instances) {
      const std::span<const std::uint8_t> voxels = models_[instance.model].voxels;
      for (std::size_t at = 0; at < voxels.size(); at += kVoxelBytes) {
        const std::uint8_t* voxel = voxels.data() + at;
        if (voxel[3] == 0) {
          continue;
        }
        const auto world = [&](std::size_t i) {
          return instance.sign[i] * voxel[instance.axis[i]] + instance.offset[i] - box_.low[i];
        };
        visit(world(0), world(1), world(2), voxel[3]);
      }
    }
  }

  void read_chunks(ProgressMeter& meter) {
    ByteReader file(file_.bytes);
    file.expect("VOX ", "MagicaVoxel file");
    const std::uint32_t version = file.u32();
    fail_if(version != 150 && version != 200, "version ", version,
            " at byte offset 4 is not supported, only 150 and 200 are");
    const ChunkHead main = read_head(file);
    fail_if(main.id != "MAIN", vox_place(main.id, main.offset), ": the first chunk must be MAIN");
    file.skip(main.content_bytes);
    ByteReader chunks = file.sub(main.children_bytes, vox_place(main.id, main.offset));
    while (chunks.remaining() > 0) {
      const ChunkHead head = read_head(chunks);
      ByteReader chunk = chunks.sub(head.content_bytes, vox_place(head.id, head.offset));
      chunks.skip(head.children_bytes);  // no known chunk but MAIN has children
      if (head.id == "SIZE") {
        read_size(chunk);
      } else if (head.id == "XYZI") {
        read_voxels(chunk, meter);
      } else if (head.id == "TDCZ") {
        read_packed(chunk, meter);
      } else if (head.id == "RGBA") {
        read_rgba(chunk, palette_);
      } else if (head.id == "MATT") {
        read_matt(chunk, palette_);
      } else if (head.id == "MATL") {
        read_matl(chunk, palette_);
      } else if (const auto* const node = std::find(kVoxNodes.begin(), kVoxNodes.end(), head.id);
                 node != kVoxNodes.end()) {
        scene_.add_node(chunk, static_cast<std::size_t>(node - kVoxNodes.begin()), head.offset);
      } else if (head.id == "LAYR") {
        scene_.add_layer(chunk);
      }
      // PACK only repeats the number of models, which their chunks tell better.
      meter.at(chunks.offset());
    }
    check_size_used();
    fail_if(models_.empty(), vox_place(main.id, main.offset),
            ": holds no model, no XYZI or TDCZ chunk is there");
  }

  void check_size_used() const {
    fail_if(size_pending_, pending_place_, ": no XYZI chunk follows before the next SIZE or the end");
  }

  void read_size(ByteReader& chunk) {
    check_size_used();
    for (std::uint32_t& side : pending_size_) {
      side = chunk.u32();
      chunk.fail_if(side > kVoxModelSideLimit, "a side of ", side, " voxels is over the limit of ",
                    kVoxModelSideLimit);
    }
    size_pending_ = true;
    pending_place_ = chunk.place();
  }

  Model take_size(ByteReader& chunk) {
    chunk.fail_if(!size_pending_, "no SIZE chunk stands before it");
    size_pending_ = false;
    Model model;
    model.size = pending_size_;
    return model;
  }

  /// As the game Teardown writes it: the size again, then a byte a voxel, x the fastest, by zlib.
  void read_packed(ByteReader& chunk, ProgressMeter& meter) {
    Model model = take_size(chunk);
    std::uint64_t count = 1;
    for (std::size_t i = 0; i < 3; ++i) {
      chunk.fail_if(chunk.u32() != model.size[i], "its size is not that of the SIZE chunk before it");
      count *= model.size[i];
    }
    constexpr std::uint64_t kAlwaysBytes = 256 << 20;
    unpacked_bytes_ += count;
    chunk.fail_if(unpacked_bytes_ > kAlwaysBytes && unpacked_bytes_ / 100 > file_.bytes.size(),
                  "packed models are more than 100 times what the file has");
    const SharedBytes dense =
        inflate_bytes(chunk.take(chunk.remaining()), Deflated::kZlib, count, chunk.place());
    chunk.fail_if(dense.bytes.size() != count, "it unpacks to ", dense.bytes.size(), " voxels, not ", count);
    const auto solid =
        count - static_cast<std::uint64_t>(std::count(dense.bytes.begin(), dense.bytes.end(), 0));
    std::vector<std::uint8_t> voxels;
    voxels.reserve(static_cast<std::size_t>(solid * kVoxelBytes));
    for (std::uint64_t i = 0; i < count; ++i) {
      const std::uint8_t material = dense.bytes[i];
      if (material != 0) {
        const std::uint64_t row = i / model.size[0];
        voxels.insert(voxels.end(), {static_cast<std::uint8_t>(i % model.size[0]),
                                     static_cast<std::uint8_t>(row % model.size[1]),
                                     static_cast<std::uint8_t>(row / model.size[1]), material});
      }
    }
    model.empty = voxels.empty();
    model.voxels = unpacked_.emplace_back(std::move(voxels));
    models_.push_back(model);
    meter.at(chunk.offset());
  }

  void read_voxels(ByteReader& chunk, ProgressMeter& meter) {
    Model model = take_size(chunk);
    const std::uint32_t count = chunk.u32();
    chunk.fail_if(chunk.remaining() / kVoxelBytes < count, count, " voxels of 4 bytes do not fit the ",
                  chunk.remaining(), " bytes that are left");
    const std::uint64_t first_offset = chunk.offset();
    model.voxels = chunk.take(std::uint64_t{count} * kVoxelBytes);
    for (std::size_t at = 0; at < model.voxels.size(); at += kVoxelBytes) {
      const std::uint8_t* voxel = model.voxels.data() + at;
      for (std::size_t i = 0; i < 3; ++i) {
        chunk.fail_if(voxel[i] >= model.size[i], "the voxel at byte offset ", first_offset + at, " lies at ",
                      voxel[i], " on the ", "xyz"[i], " axis, outside its model of ", model.size[i],
                      " voxels");
      }
      model.empty = model.empty && voxel[3] == 0;
      meter.at(static_cast<std::size_t>(first_offset) + at);
    }
    models_.push_back(model);
  }

  void place_models() {
    if (scene_.empty()) {
      frames_ = static_cast<std::uint32_t>(models_.size());
    } else if (const auto& keys = scene_.frames(); !keys.empty()) {
      frames_ = static_cast<std::uint32_t>(std::clamp<std::int64_t>(keys.back(), 0, UINT32_MAX - 1) + 1);
    }
    if (frame_ && *frame_ >= frames_) {
      throw InputError("there is no frame ", *frame_, "; the file has ",
                       frames_ == 1 ? "only frame 0" : "frames 0 to " + std::to_string(frames_ - 1));
    }
    if (scene_.empty()) {
      place_frames();
    } else {
      place_scene();
    }
  }

  /// Files from before the scene graph: further models are frames of an animation.
  void place_frames() {
    for (std::size_t number = 0; number < models_.size(); ++number) {
      const Instance instance =
          make_instance(static_cast<std::uint32_t>(number), models_[number], VoxTransform{});
      if (number == frame_.value_or(0)) {
        instances_.push_back(instance);
      }
      add_to_frames(instance);
    }
  }

  void place_scene() {
    std::uint64_t placed_voxels = 0;
    const std::int64_t frame = frame_ ? std::int64_t{*frame_} : std::numeric_limits<std::int64_t>::min();
    const std::uint32_t visits = scene_.place_models(
        frame, [&](std::uint32_t number, const VoxTransform& transform, std::uint64_t offset) {
          const std::string at = vox_place("nSHP", offset);
          fail_if(number >= models_.size(), at, ": model ", number, " is not among the ", models_.size(),
                  " models of this file");
          fail_if(instances_.size() == kVoxInstanceLimit, at, ": the scene places more than the limit of ",
                  kVoxInstanceLimit, " models");
          const Model& model = models_[number];
          placed_voxels += model.voxels.size() / kVoxelBytes;
          fail_if(placed_voxels > kVoxPlacedVoxelLimit, at, ": the scene places more than the limit of ",
                  kVoxPlacedVoxelLimit, " voxels");
          instances_.push_back(make_instance(number, model, transform));
          add_to_frames(instances_.back());
        });
    const std::vector<std::int64_t>& keys = scene_.frames();
    if (keys.size() * visits <= kVoxAnimationLimit) {
      for (const std::int64_t key : keys) {
        scene_.place_models(key, [&](std::uint32_t number, const VoxTransform& transform, std::uint64_t) {
          if (keys.size() > 1 && number < models_.size()) {
            add_to_frames(make_instance(number, models_[number], transform));
          } else if (keys.size() > 1 && notes.empty()) {
            notes.push_back(concat("frame ", key, " is broken: it shows model ", number,
                                   ", which is not among the ", models_.size(), " models of this file"));
          }
        });
      }
    }
    scene_ = VoxScene{};
    note_if(instances_.empty(), notes, "all its models are hidden, or its scene graph places none");
    std::erase_if(instances_, [&](const Instance& instance) { return models_[instance.model].empty; });
  }

  /// The boxes that the file declares count, not only what is solid in them, so that the voxels of a single
  /// model keep their indices.
  void add_to_frames(const Instance& instance) {
    const Model& model = models_[instance.model];
    if (model.empty) {
      return;
    }
    const std::uint64_t voxels = model.voxels.size() / kVoxelBytes;
    if (in_frames_.size() < kVoxInstanceLimit && voxels <= kVoxPlacedVoxelLimit - voxels_in_frames_ &&
        in_frames_.insert(instance).second) {
      voxels_in_frames_ += voxels;
    }
    std::array<std::int32_t, 3> last = instance.offset;
    for (std::size_t i = 0; i < 3; ++i) {
      last[i] += instance.sign[i] * (static_cast<std::int32_t>(model.size[instance.axis[i]]) - 1);
    }
    box_.add(instance.offset);
    box_.add(last);
  }

  SharedBytes file_;
  Palette palette_ = vox_default_palette();
  std::deque<std::vector<std::uint8_t>> unpacked_;  // voxels of models that were packed
  std::vector<Model> models_;
  std::vector<Instance> instances_;
  std::set<Instance> in_frames_;  // those of all frames, each once
  Extent<std::int32_t> box_{};    // of all frames: what lies in its lowest corner is at 0,0,0
  std::uint32_t frames_ = 1;

  // Only while reading.
  VoxScene scene_;
  std::optional<std::uint32_t> frame_;
  std::uint64_t voxels_in_frames_ = 0;
  std::uint64_t unpacked_bytes_ = 0;  // of all packed models
  bool size_pending_ = false;         // a SIZE waits for its XYZI
  std::array<std::uint32_t, 3> pending_size_{};
  std::string pending_place_;
};

}  // namespace

Palette vox_default_palette() {
  Palette palette{};
  std::size_t next = 1;
  // A cube of six levels an axis, white first, blue fastest; its last colour, black, is left to the ramps.
  const auto level = [](int step) { return static_cast<std::uint8_t>(255 - 51 * step); };
  for (int red = 0; red < 6; ++red) {
    for (int green = 0; green < 6; ++green) {
      for (int blue = 0; blue < 6; ++blue) {
        palette[next++].color = {level(red), level(green), level(blue)};
      }
    }
  }
  --next;
  // Ramps of red, green, blue and grey through the multiples of 17 that the cube does not have.
  for (int ramp = 0; ramp < 4; ++ramp) {
    for (int step = 14; step >= 1; --step) {
      if (step % 3 == 0) {
        continue;
      }
      const auto value = static_cast<std::uint8_t>(17 * step);
      const auto channel = [&](int own) { return ramp == own || ramp == 3 ? value : std::uint8_t{0}; };
      palette[next++].color = {channel(0), channel(1), channel(2)};
    }
  }
  return palette;
}

/// Beyond the file, memory is a small multiple of the chunks in the file (some 100 bytes a node or model) plus 24 bytes
/// a placed model. Voxels come model by model in the scene graph's order (depth first, children as listed), each in the
/// order of its XYZI chunk. A scene whose models are all hidden is read and holds no voxels.
///
/// Of an animation of more than `kVoxAnimationLimit` nodes in all frames together, the lowest corner, and what
/// `for_each_in_frames` visits, is that of the frame taken; it visits as many models and voxels as a scene may place.
///
/// @throws InputError  wrong magic or version; no model; a chunk, string or count that leaves its place; a
///   side over 256; a voxel outside its model; a scene graph without node 0, with an id used twice, a missing
///   node or model or a cycle; a rotation byte that is none; a frame that there is not; any of the limits above
Source read_vox(const SharedBytes& file, const ReadOptions& options, const Progress& progress) {
  return std::make_unique<VoxFile>(file, progress, options.frame);
}

}  // namespace thimble::tools
