// MagicaVoxel files: hand-built ones for each feature, real ones against figures found with another program.
#include <doctest/doctest.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "readers/file_bytes.h"
#include "readers/read_any.h"
#include "support/file_bytes.h"
#include "support/reader_inputs.h"

using namespace thimble::tools;
using thimble::tests::little;
using thimble::tests::vox_chunk;
using thimble::tests::vox_file;
using thimble::tests::vox_model;

namespace {

using Voxel = std::array<int, 4>;  // x, y, z, colour index
using Voxels = std::vector<Voxel>;
using Dictionary = std::vector<std::pair<std::string, std::string>>;
using Sides = std::array<std::int32_t, 3>;

// ---- a small writer of .vox bytes ----

std::string number(std::int64_t value) {
  return little(static_cast<std::uint64_t>(value), 4);
}

std::string dictionary(const Dictionary& entries) {
  std::string out = little(entries.size(), 4);
  for (const auto& [key, value] : entries) {
    out += little(key.size(), 4) + key + little(value.size(), 4) + value;
  }
  return out;
}

std::string transform_chunk(int id, int child, const std::vector<Dictionary>& frames,
                            const Dictionary& attributes = {}, int layer = -1) {
  std::string content = number(id) + dictionary(attributes) + number(child) + number(-1) + number(layer) +
                        little(frames.size(), 4);
  for (const Dictionary& frame : frames) {
    content += dictionary(frame);
  }
  return vox_chunk("nTRN", content);
}

std::string group_chunk(int id, const std::vector<int>& children) {
  std::string content = number(id) + dictionary({}) + little(children.size(), 4);
  for (const int child : children) {
    content += number(child);
  }
  return vox_chunk("nGRP", content);
}

std::string shape_chunk(int id, const std::vector<std::pair<int, Dictionary>>& models) {
  std::string content = number(id) + dictionary({}) + little(models.size(), 4);
  for (const auto& [model, attributes] : models) {
    content += number(model) + dictionary(attributes);
  }
  return vox_chunk("nSHP", content);
}
std::string shape_chunk(int id, int model) {
  return shape_chunk(id, {{model, {}}});
}

std::string layer_chunk(int id, const Dictionary& attributes) {
  return vox_chunk("LAYR", number(id) + dictionary(attributes) + number(-1));
}

Dictionary moved(int x, int y, int z) {
  return {{"_t", std::to_string(x) + " " + std::to_string(y) + " " + std::to_string(z)}};
}

// ---- reading it back ----

std::unique_ptr<VoxelModel> read(const std::string& bytes, const ReadOptions& options = {}) {
  return std::get<std::unique_ptr<VoxelModel>>(read_vox(SharedBytes::own(bytes), options, {}));
}

Voxels voxels_of(const VoxelModel& model, bool in_frames = false) {
  Voxels voxels;
  const auto add = [&](std::int32_t x, std::int32_t y, std::int32_t z, std::uint8_t material) {
    voxels.push_back({x, y, z, material});
  };
  in_frames ? model.for_each_in_frames(add) : model.for_each(add);
  return voxels;
}

Voxels read_voxels(const std::string& bytes) {
  return voxels_of(*read(bytes));
}

std::string refusal(const std::string& bytes) {
  return test::error_of(read_vox, bytes);
}

/// The sentence names each of `parts`.
void check_refused(const std::string& bytes, const std::vector<std::string>& parts) {
  const std::string sentence = refusal(bytes);
  INFO("sentence: ", sentence);
  CHECK_FALSE(sentence.empty());
  for (const std::string& part : parts) {
    CAPTURE(part);
    CHECK(test::contains(sentence, part));
  }
}

// ---- what should come out, by matrices of doubles applied to voxel centres ----

struct Matrix {
  std::array<std::array<double, 3>, 3> rows{};
  std::array<double, 3> shift{};

  std::array<double, 3> applied_to(const std::array<double, 3>& v) const {
    std::array<double, 3> result = shift;
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) {
        result[i] += rows[i][j] * v[j];
      }
    }
    return result;
  }
};

/// A signed permutation and the byte that packs it.
struct Turn {
  Matrix matrix;
  int packed = 0;
};

/// All 48: 24 rotations and their mirrors.
std::vector<Turn> all_turns() {
  std::vector<Turn> turns;
  std::array<std::size_t, 3> columns{0, 1, 2};
  do {
    for (int signs = 0; signs < 8; ++signs) {
      Turn turn;
      turn.packed = static_cast<int>(columns[0] | columns[1] << 2) | signs << 4;
      for (std::size_t row = 0; row < 3; ++row) {
        turn.matrix.rows[row][columns[row]] = (signs >> row & 1) != 0 ? -1 : 1;
      }
      turns.push_back(turn);
    }
  } while (std::next_permutation(columns.begin(), columns.end()));
  return turns;
}

/// By the matrices of the nodes above them, the root's first.
void place(const std::vector<Matrix>& path, std::array<int, 3> size, const Voxels& voxels, Voxels& out) {
  for (const Voxel& voxel : voxels) {
    std::array<double, 3> centre{};
    for (std::size_t i = 0; i < 3; ++i) {
      centre[i] = voxel[i] + 0.5 - std::floor(size[i] / 2.0);
    }
    for (std::size_t node = path.size(); node-- > 0;) {
      centre = path[node].applied_to(centre);
    }
    out.push_back({0, 0, 0, voxel[3]});
    for (std::size_t i = 0; i < 3; ++i) {
      out.back()[i] = static_cast<int>(std::floor(centre[i]));
    }
  }
}

Voxels from_zero(Voxels voxels) {
  for (std::size_t i = 0; i < 3; ++i) {
    int low = 1 << 30;
    for (const Voxel& voxel : voxels) {
      low = std::min(low, voxel[i]);
    }
    for (Voxel& voxel : voxels) {
      voxel[i] -= low;
    }
  }
  return voxels;
}

/// Of a model's two chunks the first.
std::string size_chunk(const std::array<int, 3>& size) {
  return vox_model(size, {}).substr(0, 24);
}

/// Any, and the model's two extreme corners, so that what is solid fills the model's box.
Voxels random_voxels(std::array<int, 3> size, std::size_t count, std::mt19937& random) {
  Voxels voxels{{0, 0, 0, 1}, {size[0] - 1, size[1] - 1, size[2] - 1, 2}};
  for (std::size_t i = 0; i < count; ++i) {
    Voxel voxel{0, 0, 0, 1 + static_cast<int>(random() % 255)};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      voxel[axis] = static_cast<int>(random() % static_cast<unsigned>(size[axis]));
    }
    voxels.push_back(voxel);
  }
  return voxels;
}

const Voxels kOne{{0, 0, 0, 7}};
const std::string kOneModel = vox_model({1, 1, 1}, kOne);

}  // namespace

TEST_CASE("vox: one model -> its voxels in the file's order, with the file's indices") {
  const std::string bytes =
      vox_file(vox_model({10, 20, 256}, {{9, 3, 255, 1}, {2, 19, 200, 255}, {2, 3, 255, 9}}), 150);
  const auto model = read(bytes);
  const Voxels expected{{9, 3, 255, 1}, {2, 19, 200, 255}, {2, 3, 255, 9}};
  CHECK(voxels_of(*model) == expected);
  CHECK(voxels_of(*model) == expected);  // any number of times
  CHECK(model->size() == Sides{10, 20, 256});
}

TEST_CASE("vox: index 0 -> empty space, not delivered") {
  const auto model = read(vox_file(vox_model({9, 9, 9}, {{0, 0, 0, 0}, {5, 5, 5, 3}, {8, 8, 8, 0}})));
  CHECK(voxels_of(*model) == Voxels{{5, 5, 5, 3}});
  CHECK(model->size() == Sides{9, 9, 9});
  const auto empty = read(vox_file(vox_model({0, 0, 0}, {})));
  CHECK(voxels_of(*empty).empty());
  CHECK(empty->size() == Sides{0, 0, 0});
}

TEST_CASE("vox: no RGBA -> MagicaVoxel's default palette") {
  const auto model = read(vox_file(kOneModel));
  const Palette& palette = model->palette();
  const auto byte = [](int value) { return static_cast<std::uint8_t>(value); };
  std::size_t next = 1;
  for (int i = 0; i < 215; ++i) {  // a cube of six steps, without black
    CHECK(palette[next++].color ==
          Rgb{byte(255 - 51 * (i / 36)), byte(255 - 51 * (i / 6 % 6)), byte(255 - 51 * (i % 6))});
  }
  for (const Rgb& hue : {Rgb{1, 0, 0}, Rgb{0, 1, 0}, Rgb{0, 0, 1}, Rgb{1, 1, 1}}) {
    for (const int level : {238, 221, 187, 170, 136, 119, 85, 68, 34, 17}) {
      CHECK(palette[next++].color == Rgb{byte(level * hue.r), byte(level * hue.g), byte(level * hue.b)});
    }
  }
  CHECK(palette[255].alpha == 255);
  CHECK(palette[255].kind == SurfaceKind::kDiffuse);
}

TEST_CASE("vox: RGBA -> entry c - 1 is colour c, whatever IMAP says") {
  std::string rgba;
  for (unsigned i = 0; i < 256; ++i) {
    rgba += little(i | (255 - i) << 8 | (i ^ 0x55u) << 16 | (i / 2) << 24, 4);
  }
  std::string map;
  for (unsigned i = 0; i < 256; ++i) {
    map += static_cast<char>(i * 7 + 3);
  }
  const auto model = read(vox_file(kOneModel + vox_chunk("RGBA", rgba) + vox_chunk("IMAP", map)));
  CHECK(voxels_of(*model) == kOne);
  for (unsigned c = 1; c < 256; ++c) {
    const unsigned i = c - 1;
    const Material& material = model->palette()[c];
    CHECK(material.color == Rgb{static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(255 - i),
                                static_cast<std::uint8_t>(i ^ 0x55u)});
    CHECK(material.alpha == i / 2);
  }
}

TEST_CASE("vox: MATT -> kind, weight and the values whose bits are set") {
  const std::string glass = number(5) + number(2) + little(0.75F) + number(0x7F) + little(1.0F) +
                            little(0.25F) + little(0.5F) + little(0.125F) + little(2.0F) + little(3.0F) +
                            little(0.375F);
  // A weight beyond 1, bit 7 without a value.
  const std::string metal = number(9) + number(1) + little(2.0F) + number(0x88) + little(0.5F);
  const std::string emit = number(10) + number(3) + little(1.0F) + number(0x40) + little(std::nanf(""));
  const auto model = read(vox_file(
      kOneModel + vox_chunk("MATT", glass) + vox_chunk("MATT", metal) + vox_chunk("MATT", emit), 150));
  const Material& a = model->palette()[5];
  CHECK(a.kind == SurfaceKind::kGlass);
  CHECK(a.weight == 0.75);
  CHECK(a.roughness == 0.25);
  CHECK(a.ior == 1.125);
  CHECK(a.attenuation == 2);
  CHECK(a.flux == 3);
  CHECK(a.emission == 0.375);
  CHECK(a.color == Rgb{255, 255, 51});  // still the palette's
  const Material& b = model->palette()[9];
  CHECK(b.kind == SurfaceKind::kMetal);
  CHECK(b.weight == 1);
  CHECK(b.ior == 1.5);
  CHECK(b.roughness == 0);
  CHECK(model->palette()[10].kind == SurfaceKind::kEmit);
  CHECK(model->palette()[10].emission == 0);  // NaN leaves the default
}

TEST_CASE("vox: MATL -> kind and values, newer names before older ones, bad numbers ignored") {
  const auto matl = [](int id, const Dictionary& entries) {
    return vox_chunk("MATL", number(id) + dictionary(entries));
  };
  const auto model = read(vox_file(
      kOneModel +
      matl(1, {{"_type", "_glass"},
               {"_weight", "0.5"},
               {"_rough", "0.1"},
               {"_spec", "0.25"},
               {"_ri", "1.5"},
               {"_ior", "0.3"},
               {"_att", "0.125"},
               {"_trans", "0.75"},
               {"_alpha", "0.5"}}) +
      matl(2, {{"_type", "_emit"}, {"_emit", "0.4"}, {"_flux", "4"}, {"_ior", "0.25"}}) +
      matl(3, {{"_type", "_media"}, {"_d", "0.05"}, {"_density", "0.5"}, {"_alpha", "0.25"}}) +
      matl(4, {{"_type", "_metal"}, {"_metal", "7"}, {"_rough", "-1"}, {"_sp", "0.5"}, {"_d", "0.05"}}) +
      matl(5, {{"_rough", "nan"}, {"_spec", "x"}, {"_weight", ""}, {"_ri", "inf"}, {"_emit", "0.5 "}}) +
      matl(256, {{"_type", "_metal"}})));
  const Palette& palette = model->palette();
  constexpr std::array kKinds{SurfaceKind::kGlass, SurfaceKind::kEmit, SurfaceKind::kMedia,
                              SurfaceKind::kMetal};
  for (std::size_t i = 0; i < kKinds.size(); ++i) {
    CHECK(palette[1 + i].kind == kKinds[i]);
  }
  CHECK(palette[255].kind == SurfaceKind::kDiffuse);
  const auto values = [](const Material& m) {
    return std::vector<double>{m.weight, m.roughness, m.ior, m.attenuation, m.transparency};
  };
  CHECK(values(palette[1]) == std::vector<double>{0.5, 0.1, 1.5, 0.125, 0.75});
  CHECK(palette[2].emission == 0.4);
  CHECK(palette[2].flux == 4);
  CHECK(palette[2].ior == 1.25);
  CHECK(palette[3].density == 0.5);
  CHECK(palette[3].transparency == 0.25);
  CHECK(palette[4].metalness == 1);
  CHECK(palette[4].density == 0.05);
  CHECK(values(palette[4]) == std::vector<double>{1, 0, 1.3, 0, 0});
  CHECK(palette[5].roughness == 0);
  CHECK(palette[5].weight == 1);
  CHECK(std::isfinite(palette[5].ior));
}

TEST_CASE("vox: random nested groups with rotations -> as the product of their matrices") {
  const std::uint32_t seed = 7;
  CAPTURE(seed);
  std::mt19937 random(seed);
  const std::vector<Turn> turns = all_turns();
  for (int round = 0; round < 40; ++round) {
    CAPTURE(round);
    const std::array<int, 3> size{1 + static_cast<int>(random() % 6), 1 + static_cast<int>(random() % 6),
                                  1 + static_cast<int>(random() % 6)};
    const Voxels voxels = random_voxels(size, 8, random);
    std::string chunks = vox_model(size, voxels);
    Voxels expected;
    // Node 2d is the transform at depth d, 2d + 1 its group, of two children: a shape of its own and the
    // next.
    std::vector<Matrix> path;
    const int depth = 5;
    for (int level = 0; level < depth; ++level) {
      const Turn& turn = turns[random() % turns.size()];
      Matrix local = turn.matrix;
      std::array<int, 3> shift{};
      for (std::size_t i = 0; i < 3; ++i) {
        shift[i] = static_cast<int>(random() % 41) - 20;
        local.shift[i] = shift[i];
      }
      path.push_back(local);
      Dictionary frame = moved(shift[0], shift[1], shift[2]);
      frame.emplace_back("_r", std::to_string(turn.packed));
      std::vector<int> children{100};
      if (level + 1 < depth) {
        children.push_back(2 * level + 2);
      }
      // Children before parents in the file: order of chunks must not matter.
      chunks = transform_chunk(2 * level, 2 * level + 1, {frame}) + chunks;
      chunks = group_chunk(2 * level + 1, children) + chunks;
      place(path, size, voxels, expected);
    }
    chunks = chunks + shape_chunk(100, 0);
    CHECK(read_voxels(vox_file(chunks)) == from_zero(expected));
  }
}

TEST_CASE("vox: a byte that packs no rotation -> refused, all others -> read") {
  int good = 0;
  for (int packed = 0; packed < 256; ++packed) {
    const std::string bytes =
        vox_file(kOneModel + transform_chunk(0, 1, {{{"_r", std::to_string(packed)}}}) + shape_chunk(1, 0));
    const int row0 = packed & 3, row1 = packed >> 2 & 3;
    if (row0 != 3 && row1 != 3 && row0 != row1) {
      CHECK(refusal(bytes) == "");
      ++good;
    } else {
      check_refused(bytes, {"nTRN chunk at byte offset", "_r"});
    }
  }
  CHECK(good == 96);
  for (const char* text : {"256", "-1", "", "4 ", "x"}) {
    CAPTURE(text);
    check_refused(vox_file(kOneModel + transform_chunk(0, 1, {{{"_r", text}}}) + shape_chunk(1, 0)), {"_r"});
  }
}

TEST_CASE("vox: hidden nodes and layers -> left out with all below them") {
  const std::string models = vox_model({1, 1, 1}, {{0, 0, 0, 1}}) + vox_model({1, 1, 1}, {{0, 0, 0, 2}}) +
                             vox_model({1, 1, 1}, {{0, 0, 0, 3}}) + vox_model({1, 1, 1}, {{0, 0, 0, 4}});
  const std::string shapes =
      shape_chunk(10, 0) + shape_chunk(11, 1) + shape_chunk(12, 2) + shape_chunk(13, 3);
  const std::string top =
      transform_chunk(0, 1, {{}}) + group_chunk(1, {2, 3, 4, 5}) + group_chunk(6, {11, 12});
  const auto scene = [&](const Dictionary& third, int fourth_layer) {
    return vox_file(models + shapes + top + transform_chunk(2, 10, {moved(1, 0, 0)}, {{"_hidden", "0"}}, 0) +
                    transform_chunk(3, 6, {moved(2, 0, 0)}, third, 1) +
                    transform_chunk(4, 12, {moved(3, 0, 0)}, {{"_name", "x"}}, -1) +
                    transform_chunk(5, 13, {moved(4, 0, 0)}, {}, fourth_layer) +
                    layer_chunk(0, {{"_hidden", "0"}}) + layer_chunk(1, {}) +
                    layer_chunk(2, {{"_name", "dark"}, {"_hidden", "1"}}) +
                    layer_chunk(-1, {{"_hidden", "1"}}));
  };
  CHECK(read_voxels(scene({}, 0)) ==
        Voxels{{0, 0, 0, 1}, {1, 0, 0, 2}, {1, 0, 0, 3}, {2, 0, 0, 3}, {3, 0, 0, 4}});
  CHECK(read_voxels(scene({{"_hidden", "1"}}, 0)) == Voxels{{0, 0, 0, 1}, {2, 0, 0, 3}, {3, 0, 0, 4}});
  CHECK(read_voxels(scene({{"_hidden", "1"}}, 2)) == Voxels{{0, 0, 0, 1}, {2, 0, 0, 3}});
  const auto nothing =
      read(vox_file(kOneModel + transform_chunk(0, 1, {{}}, {{"_hidden", "1"}}) + shape_chunk(1, 0)));
  CHECK(voxels_of(*nothing).empty());
  CHECK(nothing->size() == Sides{0, 0, 0});
  REQUIRE(nothing->notes.size() == 1);
  CHECK(nothing->notes[0].find("models are hidden") != std::string::npos);
}

TEST_CASE("vox: animations -> their first frame") {
  const std::string models = vox_model({1, 1, 1}, {{0, 0, 0, 1}}) + vox_model({1, 1, 1}, {{0, 0, 0, 2}}) +
                             vox_model({1, 1, 1}, {{0, 0, 0, 3}});
  // Without a scene graph further models are frames.
  CHECK(read_voxels(vox_file(vox_chunk("PACK", number(3)) + models, 150)) == Voxels{{0, 0, 0, 1}});
  CHECK(read_voxels(vox_file(models + transform_chunk(0, 1, {{}}) +
                             shape_chunk(1, {{2, {{"_f", "4"}}}, {1, {{"_f", "0"}}}, {0, {{"_f", "9"}}}}))) ==
        Voxels{{0, 0, 0, 2}});
  Dictionary late = moved(9, 0, 0), early = moved(2, 0, 0);
  late.emplace_back("_f", "3");
  early.emplace_back("_f", "1");
  CHECK(read_voxels(vox_file(models + transform_chunk(0, 1, {{}}) + group_chunk(1, {2, 3}) +
                             transform_chunk(2, 4, {late, early}) + transform_chunk(3, 4, {{}}) +
                             shape_chunk(4, 2))) == Voxels{{2, 0, 0, 3}, {0, 0, 0, 3}});
}

TEST_CASE("vox: --frame -> what its keys say, in a box that holds all frames") {
  const auto at = [](const std::string& bytes, std::uint32_t frame) { return read(bytes, {"", frame}); };
  const std::string models = vox_model({1, 1, 1}, {{0, 0, 0, 1}}) + vox_model({3, 1, 1}, {{2, 0, 0, 2}});
  // Without a scene graph: model by model, each about its middle.
  const std::string film = vox_file(models, 150);
  CHECK(read(film)->frames() == 2);
  CHECK(read(film)->size() == Sides{3, 1, 1});
  CHECK(voxels_of(*at(film, 0)) == Voxels{{1, 0, 0, 1}});
  CHECK(voxels_of(*at(film, 1)) == Voxels{{2, 0, 0, 2}});
  // With one: keys hold until the next, and what moves does so within one box.
  Dictionary first = moved(0, 0, 0), later = moved(10, 0, 0);
  later.emplace_back("_f", "5");
  const std::string scene = vox_file(models + transform_chunk(0, 1, {later, first}) +
                                     shape_chunk(1, {{0, {{"_f", "0"}}}, {1, {{"_f", "7"}}}}));
  CHECK(read(scene)->frames() == 8);
  CHECK(read(scene)->size() == Sides{12, 1, 1});
  CHECK(voxels_of(*read(scene)) == voxels_of(*at(scene, 0)));
  CHECK(voxels_of(*at(scene, 4)) == Voxels{{0, 0, 0, 1}});
  CHECK(voxels_of(*at(scene, 6)) == Voxels{{10, 0, 0, 1}});
  CHECK(voxels_of(*at(scene, 7)) == Voxels{{11, 0, 0, 2}});
  // A later frame that shows a model which is not there is noted, once, and refused where it is wanted.
  CHECK(read(scene)->notes.empty());
  const std::string broken =
      vox_file(models + transform_chunk(0, 1, {first}) +
               shape_chunk(1, {{0, {{"_f", "0"}}}, {7, {{"_f", "3"}}}, {8, {{"_f", "4"}}}}));
  REQUIRE(read(broken)->notes.size() == 1);
  CHECK(read(broken)->notes[0].find("frame 3 is broken: it shows model 7, which is not among the 2") == 0);
  CHECK_THROWS_AS(at(broken, 3), InputError);
  // All of it in one, each model once where it stands, whichever frame is taken.
  CHECK(voxels_of(*read(film), true) == Voxels{{1, 0, 0, 1}, {2, 0, 0, 2}});
  CHECK(voxels_of(*read(scene), true) == Voxels{{0, 0, 0, 1}, {10, 0, 0, 1}, {11, 0, 0, 2}});
  CHECK(voxels_of(*at(scene, 7), true) == voxels_of(*read(scene), true));
  CHECK_THROWS_WITH_AS(at(scene, 8), "there is no frame 8; the file has frames 0 to 7", InputError);
  CHECK_THROWS_WITH_AS(at(vox_file(kOneModel), 1), "there is no frame 1; the file has only frame 0",
                       InputError);
  // Hidden layers stay hidden in every frame.
  const std::string hidden =
      vox_file(models + layer_chunk(3, {{"_hidden", "1"}}) + transform_chunk(0, 1, {first}, {}, -1) +
               group_chunk(1, {2, 4}) + transform_chunk(2, 3, {first, later}, {}, 3) + shape_chunk(3, 0) +
               transform_chunk(4, 5, {first, later}) + shape_chunk(5, 1));
  CHECK(voxels_of(*at(hidden, 5)).size() == 1);
}

TEST_CASE("vox: unknown chunks, children of chunks and bytes behind MAIN -> ignored") {
  const std::string bytes = vox_file(vox_chunk("ABCD", number(1), vox_chunk("XYZI", number(99))) + kOneModel +
                                     vox_chunk("rCAM", std::string("anything")) + vox_chunk("NOTE", {})) +
                            std::string{1, 2, 3};
  CHECK(read_voxels(bytes) == kOne);
}

TEST_CASE("vox: what is not a .vox file -> refused with place and limit") {
  check_refused("", {"VOX "});
  check_refused("VOX", {"VOX "});
  check_refused(std::string("VOX!") + number(150), {"VOX "});
  check_refused(std::string("VOX ") + number(151), {"151", "150", "200", "byte offset 4"});
  check_refused(std::string("VOX ") + number(150) + vox_chunk("SIZE", {}),
                {"SIZE chunk at byte offset 8", "MAIN"});
  check_refused(vox_file({}), {"no model"});
  check_refused(vox_file(size_chunk({1, 1, 1})), {"SIZE chunk at byte offset 20", "XYZI"});
  check_refused(vox_file(size_chunk({1, 1, 1}) + kOneModel), {"SIZE chunk at byte offset 20", "XYZI"});
  check_refused(vox_file(kOneModel.substr(24)), {"XYZI chunk at byte offset 20", "SIZE"});
  check_refused(vox_file(size_chunk({1, 257, 1}) + kOneModel.substr(24)),
                {"SIZE chunk at byte offset 20", "257", "256"});
  check_refused(vox_file(size_chunk({1, -1, 1}) + kOneModel.substr(24)), {"SIZE chunk", "256"});
  check_refused(vox_file(vox_model({4, 4, 4}, {{0, 0, 0, 1}, {3, 4, 3, 1}})),
                {"XYZI chunk at byte offset 44", "byte offset 64", "y axis"});
  check_refused(vox_file(size_chunk({4, 4, 4}) + vox_chunk("XYZI", number(0x80000001u) + number(0))),
                {"XYZI chunk at byte offset 44", "2147483649 voxels"});
  check_refused(vox_file(size_chunk({4, 4, 4}) + vox_chunk("XYZI", std::string("ab"))),
                {"XYZI chunk at byte offset 44"});
  check_refused(vox_file(kOneModel + std::string("\x01YZ\xff") + number(0xffffffffu) + number(0xffffffffu)),
                {"?YZ? chunk at byte offset 64", "8589934590"});
  check_refused(vox_file(kOneModel + std::string("nTRN") + number(1)), {"MAIN chunk", "truncated"});
  check_refused(vox_file(kOneModel + vox_chunk("RGBA", number(0) + "ab")), {"RGBA chunk", "truncated"});
  check_refused(vox_file(kOneModel + vox_chunk("MATL", number(257) + dictionary({}))), {"MATL chunk", "257"});
  check_refused(vox_file(kOneModel + vox_chunk("MATL", number(1) + number(0xffffffffu))),
                {"MATL chunk", "truncated"});
  check_refused(
      vox_file(kOneModel + vox_chunk("MATL", number(1) + number(1) + number(0xfffffff0u) + "_type")),
      {"MATL chunk", "truncated"});
  check_refused(vox_file(kOneModel + vox_chunk("MATT", number(1) + number(0) + little(1.0F) + number(2))),
                {"MATT chunk", "truncated"});
}

TEST_CASE("vox: a scene graph that is none -> refused with the chunk") {
  const auto scene = [](const std::string& chunks) { return vox_file(kOneModel + chunks); };
  const std::string shape = shape_chunk(1, 0);
  check_refused(scene(shape), {"no root"});
  check_refused(scene(transform_chunk(0, 5, {{}}) + shape), {"nTRN chunk at byte offset 64", "child 5"});
  check_refused(scene(transform_chunk(0, -1, {{}})), {"child -1"});
  check_refused(scene(transform_chunk(0, 1, {{}}) + shape + shape), {"nSHP chunk", "node id 1"});
  check_refused(scene(transform_chunk(-2, 1, {{}})), {"node id -2"});
  check_refused(scene(shape_chunk(0, 1)), {"nSHP chunk at byte offset 64", "model 1", "1 models"});
  check_refused(scene(shape_chunk(0, -1)), {"nSHP chunk"});
  check_refused(scene(transform_chunk(0, 0, {{}})), {"cycle"});
  check_refused(
      scene(transform_chunk(0, 2, {{}}) + group_chunk(2, {1, 3}) + transform_chunk(3, 2, {{}}) + shape),
      {"nGRP chunk", "node 2", "cycle"});
  check_refused(scene(vox_chunk("nGRP", number(0) + dictionary({}) + number(0x40000000u) + number(1))),
                {"nGRP chunk", "1073741824"});
  check_refused(scene(vox_chunk("nSHP", number(0) + dictionary({}) + number(0xffffffffu))),
                {"nSHP chunk", "truncated"});
  check_refused(scene(vox_chunk("nTRN", number(0) + dictionary({}) + number(1) + number(-1) + number(0) +
                                            number(0xffffffffu))),
                {"nTRN chunk", "truncated"});
  CHECK(refusal(scene(shape_chunk(0, std::vector<std::pair<int, Dictionary>>{}))) == "");  // shows nothing
  CHECK(refusal(scene(transform_chunk(0, 1, {}) + shape)) == "");  // no frame: unmoved
}

TEST_CASE("vox: translations -> three whole numbers within the limit, also when nested") {
  const auto scene = [](const char* outer, const char* inner) {
    return vox_file(kOneModel + transform_chunk(0, 1, {{{"_t", outer}}}) +
                    transform_chunk(1, 2, {{{"_t", inner}}}) + shape_chunk(2, 0));
  };
  CHECK(refusal(scene("0 0 16777216", "-16777216 1 0")) == "");
  CHECK(refusal(scene("  1  2 -3 ", "0 0 0")) == "");
  check_refused(scene("0 16777217 0", "0 0 0"), {"nTRN chunk", "16777217", "16777216"});
  check_refused(scene("0 0 -16777217", "0 0 0"), {"-16777217"});
  check_refused(scene("16777216 0 0", "1 0 0"), {"nTRN chunk", "add up to 16777217", "16777216"});
  for (const char* text :
       {"", " ", "1 2", "1 2 3 4", "1,2,3", "1 2 3.5", "99999999999 0 0", "a b c", "+1 2 3"}) {
    CAPTURE(text);
    check_refused(scene(text, "0 0 0"), {"nTRN chunk", "_t"});
  }
  // The farthest apart that two models can be.
  const auto model =
      read(vox_file(kOneModel + group_chunk(0, {1, 2}) + transform_chunk(1, 3, {moved(-(1 << 24), 0, 0)}) +
                    transform_chunk(2, 3, {moved(1 << 24, 0, 0)}) + shape_chunk(3, 0)));
  CHECK(model->size() == Sides{(1 << 25) + 1, 1, 1});
  CHECK(voxels_of(*model) == Voxels{{0, 0, 0, 7}, {1 << 25, 0, 0, 7}});
}

TEST_CASE("vox: graphs that unfold without end -> stopped at a stated limit") {
  // Group n holds group n + 1 twice: 2^n copies from n chunks.
  const auto doubling = [](int levels, const std::string& last, const std::string& model = kOneModel,
                           int from = 0) {
    std::string chunks = model;
    for (int level = from; level < levels; ++level) {
      chunks += group_chunk(level, {level + 1, level + 1});
    }
    return vox_file(chunks + last);
  };
  CHECK(read_voxels(doubling(10, shape_chunk(10, 0))).size() == 1024);
  CHECK(read_voxels(doubling(16, shape_chunk(16, 0))).size() == 65536);
  check_refused(doubling(17, shape_chunk(17, 0)), {"nSHP chunk", "65536 models"});
  check_refused(doubling(60, shape_chunk(60, 0)), {"65536 models"});
  check_refused(doubling(17, group_chunk(0, {1, 17}) + shape_chunk(17, 0), kOneModel, 1), {"65536 models"});
  check_refused(doubling(60, group_chunk(60, {})), {"1048576 nodes"});
  // 65,536 copies of a model that lists 40,000 voxels are over 2^31.
  check_refused(doubling(16, shape_chunk(16, 0), vox_model({1, 1, 1}, Voxels(40000, {0, 0, 0, 1}))),
                {"2147483648 voxels"});
}

TEST_CASE("vox: a chain of 50,000 nested groups -> read without recursion") {
  std::string chunks = kOneModel;
  const int depth = 50000;
  for (int level = 0; level < depth; ++level) {
    chunks += group_chunk(level, {level + 1});
  }
  CHECK(read_voxels(vox_file(chunks + shape_chunk(depth, 0))) == kOne);
  CHECK(test::contains(refusal(vox_file(chunks + group_chunk(depth, {7}))), "cycle"));
}

TEST_CASE("vox: progress -> rises to 1, and what it throws ends the reading") {
  const std::string bytes = vox_file(vox_model({1, 1, 1}, Voxels(500'000, {0, 0, 0, 1})));
  std::vector<double> seen;
  read_any({"a.vox"}, SharedBytes::own(bytes), [&](double done) { seen.push_back(done); });
  CHECK(seen.size() > 3);
  CHECK(std::is_sorted(seen.begin(), seen.end()));
  CHECK(seen.front() > 0);
  CHECK(seen.back() == 1);
  CHECK_THROWS_AS(read_vox(SharedBytes::own(bytes), {}, [](double) { throw 42; }), int);
}

namespace {

/// A small file with a bit of everything.
std::string sampler() {
  std::string rgba;
  for (unsigned i = 0; i < 256; ++i) {
    rgba += little(i * 0x01010101u, 4);
  }
  return vox_file(vox_chunk("PACK", number(2)) + vox_model({2, 3, 4}, {{1, 2, 3, 4}, {0, 0, 0, 1}}) +
                  vox_model({1, 1, 1}, kOne) + transform_chunk(0, 1, {{}}) + group_chunk(1, {2, 4}) +
                  transform_chunk(2, 3, {{{"_r", "40"}, {"_t", "1 -2 3"}}}, {{"_name", "a"}}, 0) +
                  shape_chunk(3, 0) + transform_chunk(4, 5, {moved(7, 8, 9)}) +
                  shape_chunk(5, {{1, {{"_f", "0"}}}}) + layer_chunk(0, {{"_hidden", "0"}}) +
                  vox_chunk("RGBA", rgba) +
                  vox_chunk("MATL", number(1) + dictionary({{"_type", "_metal"}, {"_rough", "0.5"}})) +
                  vox_chunk("MATT", number(2) + number(2) + little(1.0F) + number(8) + little(0.5F)));
}

}  // namespace

TEST_CASE(
    "vox: a file cut off at each length -> refused; with any bit changed -> refused or read, never more") {
  const std::string whole = sampler();
  CHECK(test::outcome_of(read_vox, whole) == 4);
  CHECK(test::accepted_lengths(read_vox, whole).empty());
  // The same with MAIN's size mended, so that the inner checks are the ones that hold.
  for (std::size_t length = 20; length < whole.size(); ++length) {
    CAPTURE(length);
    test::outcome_of(read_vox, vox_file(whole.substr(20, length - 20)));
  }
  for (std::size_t bit = 0; bit < whole.size() * 8; ++bit) {
    std::string damaged = whole;
    damaged[bit / 8] = static_cast<char>(damaged[bit / 8] ^ 1 << bit % 8);
    test::outcome_of(read_vox, damaged);
  }
}

namespace {

struct RealFile {
  const char* path;
  std::size_t voxels;
  Sides sides;
  std::uint32_t crc32;  // of x, y, z (32 bits each, little endian) and the index, voxel after voxel
};

// Found with a script that shares nothing with the reader: it multiplies matrices and turns voxel centres.
constexpr RealFile kRealFiles[] = {
    {"vox/bevy/test.vox", 17788, {50, 128, 41}, 0x5d56bfd6u},
    {"vox/dot_vox/metal-material.vox", 20, {3, 3, 3}, 0xb522b818u},
    {"vox/dot_vox/placeholder.vox", 4, {2, 2, 2}, 0xbb6ed997u},
    {"vox/ephtracy/chr_cat.vox", 563, {12, 9, 17}, 0x0deb8817u},
    {"vox/ephtracy/chr_knight.vox", 398, {18, 8, 15}, 0x41615b37u},
    {"vox/ephtracy/chr_sol.vox", 294, {11, 7, 16}, 0x09be2aecu},
    {"vox/ephtracy/deer.vox", 355, {16, 9, 22}, 0x166c0da2u},
    {"vox/ephtracy/horse.vox", 808, {31, 7, 22}, 0x24bad47cu},
    {"vox/ephtracy/menger.vox", 160000, {81, 81, 81}, 0x2de9aabau},
    {"vox/ephtracy/monu0.vox", 12717, {60, 84, 104}, 0xe2821306u},
    {"vox/ephtracy/monu1.vox", 156942, {80, 80, 115}, 0x1b68f9fbu},
    {"vox/ephtracy/monu10.vox", 150764, {72, 72, 122}, 0x3b4191bbu},
    {"vox/ephtracy/nature.vox", 75835, {120, 120, 60}, 0x17d93f64u},
    {"vox/ephtracy/snow.vox", 1296, {81, 81, 81}, 0xdea06661u},
    {"vox/ephtracy/teapot.vox", 28411, {126, 79, 61}, 0xdf92a32fu},
    {"vox/mmmm/alien_saucer2c.vox", 34392, {48, 48, 18}, 0x2837b09eu},
    {"vox/mmmm/chr_beardo2.vox", 352, {8, 8, 12}, 0xc9a45b2cu},
    {"vox/mmmm/chr_sports1.vox", 272, {8, 5, 11}, 0x9b3ab41fu},
    {"vox/mmmm/mob_dog1.vox", 212, {6, 13, 7}, 0x5621f9aau},
    {"vox/mmmm/obj_container2.vox", 11470, {60, 15, 15}, 0xd748da72u},
    {"vox/mmmm/obj_curb1.vox", 239, {16, 14, 2}, 0xf7a9bf19u},
    {"vox/mmmm/obj_rubbish3.vox", 16, {4, 2, 2}, 0xa2956963u},
    {"vox/mmmm/obj_table2.vox", 116, {10, 10, 5}, 0x78e841a0u},
    {"vox/mmmm/obj_trashcan2.vox", 181, {6, 5, 12}, 0xd20b961au},
    {"vox/mmmm/scene_hazmat.vox", 23382, {96, 68, 23}, 0x04330481u},
    {"vox/mmmm/veh_truck2.vox", 4272, {15, 34, 13}, 0xad666dfau},
    {"vox/ogt/doom.vox", 3894, {98, 1, 115}, 0x18d22360u},
    {"vox/ogt/test_groups.vox", 1754, {84, 8, 48}, 0xe6a1c649u},
};

}  // namespace

TEST_CASE("vox: real files -> the voxels that another program finds in them") {
  const std::filesystem::path folder = test::data_folder();
  if (folder.empty()) {
    return;
  }
  for (const RealFile& real : kRealFiles) {
    CAPTURE(real.path);
    const auto model =
        std::get<std::unique_ptr<VoxelModel>>(read_scene_file({(folder / real.path).string()}));
    // That program counts from the least solid voxel, the reader from the corner of the declared boxes.
    Sides low = model->size();
    Sides high{};
    model->for_each([&](std::int32_t x, std::int32_t y, std::int32_t z, std::uint8_t) {
      low = {std::min(low[0], x), std::min(low[1], y), std::min(low[2], z)};
      high = {std::max(high[0], x + 1), std::max(high[1], y + 1), std::max(high[2], z + 1)};
    });
    CHECK(Sides{high[0] - low[0], high[1] - low[1], high[2] - low[2]} == real.sides);
    CHECK((model->size()[0] >= high[0] && model->size()[1] >= high[1] && model->size()[2] >= high[2]));
    std::string stream;
    model->for_each([&](std::int32_t x, std::int32_t y, std::int32_t z, std::uint8_t material) {
      stream += number(x - low[0]) + number(y - low[1]) + number(z - low[2]) + static_cast<char>(material);
    });
    CHECK(stream.size() == 13 * real.voxels);
    CHECK(crc32(0, reinterpret_cast<const Bytef*>(stream.data()), static_cast<uInt>(stream.size())) ==
          real.crc32);
  }
}
