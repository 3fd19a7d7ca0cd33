// Pictures on meshes: a voxel has the colour that the picture has where the voxel lies, as light, over what it covers.
#include <doctest/doctest.h>
#include <webp/encode.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "output/image.h"
#include "readers/formats.h"
#include "readers/read_any.h"
#include "readers/texture.h"
#include "scene/voxelise.h"
#include "support/file_bytes.h"
#include "support/pictures.h"
#include "support/reader_inputs.h"
#include "support/run_command.h"

using namespace thimble::tools;
using namespace thimble::tools::test;
using thimble::tests::deflated;
using thimble::tests::little;
using thimble::tests::TemporaryFolder;

namespace {

using Pixel = std::array<std::uint8_t, 4>;

constexpr Rgb kRed{255, 0, 0};
constexpr Rgb kGreen{0, 255, 0};
constexpr Rgb kBlue{0, 0, 255};
constexpr Pixel kRedPixel{255, 0, 0, 255};
constexpr Pixel kGreenPixel{0, 255, 0, 255};
constexpr Pixel kBluePixel{0, 0, 255, 255};
constexpr Pixel kWhitePixel{255, 255, 255, 255};
constexpr Pixel kBlackPixel{0, 0, 0, 255};

std::vector<std::uint8_t> bytes_of(const std::vector<Pixel>& pixels) {
  const auto* const first = pixels.front().data();
  return {first, first + 4 * pixels.size()};
}

Texture texture_of(std::int32_t width, std::int32_t height, const std::vector<Pixel>& pixels) {
  const auto bytes = std::make_shared<std::vector<std::uint8_t>>(bytes_of(pixels));
  return Texture({bytes, bytes->data()}, width, height);
}

std::string png(std::int32_t width, std::int32_t height, const std::vector<Pixel>& pixels) {
  const auto file = png_file(width, height, 4, bytes_of(pixels));
  return {file.begin(), file.end()};
}

std::string webp(std::int32_t width, std::int32_t height, const std::vector<Pixel>& pixels) {
  std::uint8_t* file = nullptr;
  const std::size_t size = WebPEncodeLosslessRGBA(pixels[0].data(), width, height, 4 * width, &file);
  const std::unique_ptr<std::uint8_t, void (*)(void*)> kept(file, WebPFree);
  return {reinterpret_cast<const char*>(file), size};
}

Rgb color_of(const Texture::Sample& sample) {
  return {screen_byte(sample.light[0]), screen_byte(sample.light[1]), screen_byte(sample.light[2])};
}

std::string red_blue() {
  return png(2, 1, {kRedPixel, kBluePixel});
}

/// A quad of one unit in the plane z = 0, its picture upright, as `.glb`; `material` and `more` are JSON.
struct Quad {
  std::string material = R"({"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}})";
  std::string picture = red_blue();
  std::string texture = R"({"source":0})";
  std::string more;        ///< members of the file
  std::string attributes;  ///< members of the primitive's
  std::array<float, 8> places{0, 1, 1, 1, 1, 0, 0, 0};
  std::array<float, 16> colors{1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1};

  std::string glb() const {
    std::string binary;
    for (const int number : {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}) {
      binary += little(static_cast<float>(number));
    }
    for (const float number : places) {
      binary += little(number);
    }
    for (const float number : colors) {
      binary += little(number);
    }
    for (const unsigned index : {0U, 1U, 2U, 0U, 2U, 3U}) {
      binary += little(index, 2);
    }
    binary += picture;
    binary.resize((binary.size() + 3) / 4 * 4);
    const std::string json =
        R"({"asset":{"version":"2.0"},)" + more + R"("scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],)" +
        R"("meshes":[{"primitives":[{"attributes":{"POSITION":0,"TEXCOORD_0":1)" + attributes +
        R"(},"indices":3,"material":0}]}],"materials":[)" + material + R"(],"textures":[)" + texture +
        R"(],"images":[{"bufferView":4}],"accessors":[)"
        R"({"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"},)"
        R"({"bufferView":1,"componentType":5126,"count":4,"type":"VEC2"},)"
        R"({"bufferView":2,"componentType":5126,"count":4,"type":"VEC4"},)"
        R"({"bufferView":3,"componentType":5123,"count":6,"type":"SCALAR"},)"
        R"({"bufferView":2,"componentType":5126,"count":4,"type":"VEC2"}],"bufferViews":[)"
        R"({"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":32},)"
        R"({"buffer":0,"byteOffset":80,"byteLength":64},{"buffer":0,"byteOffset":144,"byteLength":12},)"
        R"({"buffer":0,"byteOffset":156,"byteLength":)" +
        std::to_string(picture.size()) + R"(}],"buffers":[{"byteLength":)" + std::to_string(binary.size()) +
        "}]}";
    return thimble::tests::glb(json, binary);
  }
  Source source() const { return read_gltf(SharedBytes::own(glb()), {}, {}); }
};

using Place = std::array<std::int32_t, 2>;

/// The voxels of a mesh in the plane z = 0, by x and height.
std::map<Place, Rgb> voxels_of(const Source& source, int level = 4) {
  const auto& mesh = std::get<TriangleMesh>(source);
  const PaletteMap colors(mesh_colors(mesh, level, false));
  std::map<Place, Rgb> voxels;
  voxelise(mesh, level, false, &colors, [&](const UnitPoint& at, int, std::uint8_t material) {
    CHECK(at[1] == 1 << (level - 1));
    voxels[{at[0], at[2]}] = colors.palette()[material].color;
  });
  return voxels;
}

/// Of the columns from the left, the first letters of their colours; '.' is none, '?' another or several.
std::string columns_of(const Source& source, int level = 4) {
  std::string columns(std::size_t{1} << level, ' ');
  for (const auto& [place, color] : voxels_of(source, level)) {
    const char letter = color == kRed ? 'r' : (color == kGreen ? 'g' : (color == kBlue ? 'b' : '?'));
    char& column = columns[static_cast<std::size_t>(place[0])];
    column = column == ' ' || column == letter ? letter : '?';
  }
  return columns;
}

Source read_beside(const TemporaryFolder& folder, const std::string& name, const std::string& text) {
  return read_scene_file({folder.write(name, text)});
}

}  // namespace

TEST_CASE("texture: boxes -> averages of light; each wrap mode; what is clear has no colour to give") {
  const Texture two = texture_of(2, 1, {kRedPixel, kBluePixel});
  const auto at = [&](double u, Wrap wrap) {
    return color_of(two.average({u, 0.5, 0, 0}, wrap, Wrap::kRepeat));
  };
  CHECK(at(0.25, Wrap::kRepeat) == kRed);
  CHECK(at(1.25, Wrap::kRepeat) == kRed);
  CHECK(at(-0.25, Wrap::kRepeat) == kBlue);
  CHECK(at(1.25, Wrap::kMirror) == kBlue);
  CHECK(at(-0.25, Wrap::kMirror) == kRed);
  CHECK(at(2.25, Wrap::kMirror) == kRed);
  CHECK(at(1.25, Wrap::kClamp) == kBlue);
  CHECK(at(-7, Wrap::kClamp) == kRed);
  for (const double far : {1e300, -1e300, std::nan(""), std::numeric_limits<double>::infinity()}) {
    for (const Wrap wrap : {Wrap::kRepeat, Wrap::kMirror, Wrap::kClamp}) {
      const auto sample = two.average({far, far, far, far}, wrap, wrap);
      CHECK((sample.light[0] >= 0 && sample.light[0] + sample.light[2] <= 1.001));
    }
  }
  // Half of the light, not half of the bytes.
  CHECK(color_of(two.average({0.5, 0.5, 0.5, 0.5}, Wrap::kRepeat, Wrap::kRepeat)) == Rgb{188, 0, 188});
  CHECK(color_of(two.average({0.5, 0.5, 0.25, 0}, Wrap::kRepeat, Wrap::kRepeat)) == Rgb{188, 0, 188});
  CHECK(color_of(two.average({0.4375, 0.5, 0.25, 0}, Wrap::kRepeat, Wrap::kRepeat)) ==
        Rgb{screen_byte(0.625), 0, screen_byte(0.375)});
  const auto clear = texture_of(2, 1, {kRedPixel, {0, 255, 0, 0}}).average({0.5, 0.5, 0.5, 0.5}, {}, {});
  CHECK(clear.alpha == doctest::Approx(0.5));
  CHECK(clear.light[0] > 0.99);
  // A fine checker of any size is grey from afar, and as it is from near.
  for (const std::int32_t side : {64, 100, 333}) {
    std::vector<Pixel> pixels;
    for (std::int32_t i = 0; i < side * side; ++i) {
      pixels.push_back((i % side + i / side) % 2 == 0 ? kWhitePixel : kBlackPixel);
    }
    const Texture checker = texture_of(side, side, pixels);
    for (int i = 0; i < 50; ++i) {
      const auto sample = checker.average({i * 0.0531, i * 0.0877, 0.09, 0.07}, Wrap::kMirror, Wrap::kMirror);
      CHECK(sample.light[1] == doctest::Approx(0.5).epsilon(0.06));
      const auto near = checker.average({(i + 0.5) / side, 0.5 / side, 0.1 / side, 0.1 / side}, {}, {});
      CHECK(near.light[0] == (i % 2 == 0 ? 1 : 0));
    }
  }
}

TEST_CASE(
    "texture: on a quad of two triangles -> each voxel as the picture is there, one by one and cell by "
    "cell") {
  std::vector<Pixel> pixels;
  for (int i = 0; i < 64; ++i) {
    pixels.push_back((i % 8 + i / 8) % 2 == 0 ? kBlackPixel : kWhitePixel);
  }
  Quad quad;
  quad.picture = png(8, 8, pixels);
  for (const int level : {4, 5, 9}) {
    Source source = quad.source();
    auto& mesh = std::get<TriangleMesh>(source);
    for (const std::size_t copies : {std::size_t{1}, std::size_t{40}}) {
      if (copies > 1 && level < 9) {
        continue;
      }
      for (std::size_t i = 1; i < copies; ++i) {  // so many that they go cell by cell
        for (std::size_t k = 0; k < 2; ++k) {
          mesh.triangles.push_back(mesh.triangles[k]);
          mesh.surface_of.push_back(mesh.surface_of[k]);
        }
      }
      const auto voxels = voxels_of(source, level);
      REQUIRE(voxels.size() == std::size_t{1} << (2 * level));
      int wrong = 0;
      for (const auto& [place, color] : voxels) {
        const int column = place[0] >> (level - 3);
        const int row = 7 - (place[1] >> (level - 3));
        wrong += color == ((column + row) % 2 == 0 ? Rgb{0, 0, 0} : Rgb{}) ? 0 : 1;
      }
      CHECK(wrong == 0);
    }
  }
  // As seen from afar: a voxel covers 8 x 8 of it.
  quad.places = {0, 16, 16, 16, 16, 0, 0, 0};
  for (const auto& [place, color] : voxels_of(quad.source(), 4)) {
    CHECK(std::abs(color.g - 188) <= 1);
  }
}

TEST_CASE("gltf: the picture's coordinates -> their set, their transform, their wrap modes") {
  Quad quad;
  CHECK(columns_of(quad.source()) == "rrrrrrrrbbbbbbbb");
  quad.texture = R"({"extensions":{"EXT_texture_webp":{"source":0}}})";
  quad.picture = webp(2, 1, {kRedPixel, kBluePixel});
  quad.more = R"("extensionsRequired":["EXT_texture_webp"],)";
  CHECK(columns_of(quad.source()) == "rrrrrrrrbbbbbbbb");
  CHECK(notes_of(quad.source()).empty());
  quad = Quad();
  const auto info = [&](const std::string& more) {
    quad.material = R"({"pbrMetallicRoughness":{"baseColorTexture":{"index":0,)" + more + "}}}";
    return quad.source();
  };
  const auto moved = [&](const std::string& transform) {
    return columns_of(info(R"("extensions":{"KHR_texture_transform":{)" + transform + "}}"));
  };
  CHECK(moved(R"("offset":[0.5,0])") == "bbbbbbbbrrrrrrrr");
  CHECK(moved(R"("scale":[0.5,1])") == "rrrrrrrrrrrrrrrr");
  CHECK(moved(R"("scale":[2,1])") == "rrrrbbbbrrrrbbbb");
  CHECK(moved(R"("scale":[2,1],"offset":[0.5,0])") == "bbbbrrrrbbbbrrrr");
  CHECK(moved(R"("rotation":3.14159265358979,"offset":[1,1])") == "bbbbbbbbrrrrrrrr");
  // A quarter turn of the coordinates against the clock turns the picture with it: its left end is on top.
  const auto turned =
      voxels_of(info(R"("extensions":{"KHR_texture_transform":{"rotation":1.5707963267949}})"));
  CHECK(turned.at({8, 15}) == kRed);
  CHECK(turned.at({8, 0}) == kBlue);
  quad.attributes = R"(,"TEXCOORD_1":4)";  // which are the first half of the colours
  std::copy(quad.places.begin(), quad.places.end(), quad.colors.begin());
  quad.places.fill(0.25F);
  CHECK(columns_of(info(R"("texCoord":0)")) == "rrrrrrrrrrrrrrrr");
  CHECK(columns_of(info(R"("texCoord":1)")) == "rrrrrrrrbbbbbbbb");
  CHECK(moved(R"("texCoord":1)") == "rrrrrrrrbbbbbbbb");
  CHECK(columns_of(info(R"("texCoord":7)")) == "????????????????");  // there is none: plain
  quad.attributes = "";
  quad.places = {-1, 1, 3, 1, 3, 0, -1, 0};
  quad.material = Quad().material;
  const auto wrapped = [&](const std::string& wrap) {
    quad.texture = R"({"source":0,"sampler":0})";
    quad.more = R"("samplers":[{"wrapS":)" + wrap + "}],";
    return columns_of(quad.source());
  };
  CHECK(wrapped("10497") == "rrbbrrbbrrbbrrbb");
  CHECK(wrapped("33648") == "bbrrrrbbbbrrrrbb");
  CHECK(wrapped("33071") == "rrrrrrbbbbbbbbbb");
}

TEST_CASE(
    "gltf: base colour -> factor times picture times vertices' colours, as light; specular-glossiness, too") {
  Quad quad;
  quad.picture = png(1, 1, {{188, 188, 188, 255}});
  quad.attributes = R"(,"COLOR_0":2)";
  quad.colors = {1, 0, 1, 1, 1, 0, 1, 1, 1, 0, 1, 1, 1, 0, 1, 1};
  quad.material =
      R"({"pbrMetallicRoughness":{"baseColorFactor":[1,1,0.5,1],"baseColorTexture":{"index":0}}})";
  for (const auto& [place, color] : voxels_of(quad.source())) {
    CHECK(std::abs(color.r - 188) <= 1);
    CHECK(color.g == 0);
    CHECK(std::abs(color.b - 137) <= 1);  // a quarter of the light
  }
  // Colours of vertices run over the triangle.
  quad.picture = png(1, 1, {kWhitePixel});
  quad.material = Quad().material;
  quad.colors = {0, 0, 0, 1, 1, 1, 1, 1, 1, 1, 1, 1, 0, 0, 0, 1};
  const auto voxels = voxels_of(quad.source());
  CHECK(std::abs(voxels.at({8, 8}).g - 188) <= 5);
  CHECK(voxels.at({1, 8}).g < voxels.at({3, 8}).g);
  quad.attributes = "";
  quad.material = R"({"extensions":{"KHR_materials_pbrSpecularGlossiness":{"diffuseFactor":[0,1,0,1]}}})";
  CHECK(std::get<TriangleMesh>(quad.source()).colors[0] == kGreen);
  quad.picture = red_blue();
  quad.material = R"({"extensions":{"KHR_materials_pbrSpecularGlossiness":{"diffuseTexture":{"index":0}}}})";
  CHECK(columns_of(quad.source()) == "rrrrrrrrbbbbbbbb");
}

TEST_CASE("gltf: unlit materials alone -> their base colour without light; beside others a note") {
  Quad quad;
  quad.material =
      R"({"pbrMetallicRoughness":{"baseColorTexture":{"index":0}},"extensions":{"KHR_materials_unlit":{}}})";
  quad.more = R"("extensionsRequired":["KHR_materials_unlit"],)";
  CHECK(columns_of(quad.source()) == "rrrrrrrrbbbbbbbb");
  CHECK(notes_of(quad.source()).empty());
  CHECK(std::get<TriangleMesh>(quad.source()).is_unlit);
  quad.material = R"({"emissiveFactor":[1,1,1],"extensions":{"KHR_materials_unlit":{}}})";
  CHECK(std::get<TriangleMesh>(quad.source()).surfaces.empty());

  // A bright orange, from the side and from below, is its own bytes: 0.2 of light is 124.
  quad.material = R"({"pbrMetallicRoughness":{"baseColorFactor":[1,0.2,0,1]},)"
                  R"("extensions":{"KHR_materials_unlit":{}}})";
  const TemporaryFolder folder;
  const std::string scene = folder.write("quad.glb", quad.glb());
  for (const char* const seen : {"-30", "60"}) {
    const std::string file = folder.path("quad.png");
    CHECK(thimble::tests::run_command(
              {"render", scene, "--size", "33x33", "--tilt", seen, "-o", file, "--depth", "5", "--quiet"})
              .status == 0);
    const auto picture = thimble::tests::read_png(thimble::tests::read_text(file));
    const auto at = static_cast<std::size_t>(picture.channels) * (16 * 33 + 16);
    CHECK(static_cast<std::uint8_t>(picture.frames[0][at]) > 251);
    CHECK(std::abs(static_cast<std::uint8_t>(picture.frames[0][at + 1]) - 124) < 4);
    CHECK(static_cast<std::uint8_t>(picture.frames[0][at + 2]) == 0);
  }
  quad.attributes =
      R"(},"indices":3},{"attributes":{"POSITION":0)";  // a primitive without material before it
  CHECK(!std::get<TriangleMesh>(quad.source()).is_unlit);
  CHECK(notes_hold(quad.source(), "1 material is unlit in the file and drawn in the scene's light"));
}

TEST_CASE("mesh: colours of vertices alone -> mixed as light where the voxel lies, from each format") {
  const auto check = [](const Source& source) {
    const auto voxels = voxels_of(source, 5);
    REQUIRE(voxels.size() == 32 * 32);
    for (const auto& [place, color] : voxels) {
      // Black on the left, white on the right; the world's sides are half a voxel beyond the quad's.
      const double light = std::clamp((place[0] + 0.5) / 32, 0.0, 1.0);
      CHECK(std::abs(light_of(color.r) - light) < 0.04);
      CHECK(color.g == color.r);
    }
    CHECK(voxels.at({20, 3}) == voxels.at({20, 28}));  // of two triangles
  };
  Quad quad;
  quad.material = "{}";
  quad.attributes = R"(,"COLOR_0":2)";
  quad.colors = {0, 0, 0, 1, 1, 1, 1, 1, 1, 1, 1, 1, 0, 0, 0, 1};
  check(quad.source());
  const auto bytes = [](const std::string& text) { return SharedBytes::own(text); };
  check(read_obj(bytes("v 0 0 0 0 0 0\nv 1 0 0 1 1 1\nv 1 1 0 1 1 1\nv 0 1 0 0 0 0\nf 1 2 3 4\n"), {}, {}));
  check(read_off(
      bytes("COFF\n4 1 0\n0 0 0 0 0 0 255\n1 0 0 255 255 255 255\n1 1 0 255 255 255 255\n0 1 0 0 0 0 255\n"
            "4 0 1 2 3\n"),
      {}, {}));
  check(read_ply(bytes("ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
                       "property float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
                       "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0 0 0 0\n"
                       "1 0 0 255 255 255\n1 1 0 255 255 255\n0 1 0 0 0 0\n4 0 1 2 3\n"),
                 {}, {}));
}

TEST_CASE("mesh: colours of vertices finer than voxels -> their average as light; of a large face never") {
  TriangleMesh mesh;
  constexpr std::uint32_t kSide = 129;
  for (std::uint32_t i = 0; i < kSide * kSide; ++i) {
    mesh.positions.push_back({static_cast<double>(i % kSide), static_cast<double>(i / kSide), 0});
    mesh.colors.push_back((i % kSide + i / kSide) % 2 == 0 ? Rgb{0, 0, 0} : Rgb{});
    if (i % kSide + 1 < kSide && i / kSide + 1 < kSide) {
      mesh.triangles.push_back({i, i + 1, i + kSide + 1});
      mesh.triangles.push_back({i, i + kSide + 1, i + kSide});
    }
  }
  for (const auto& [place, color] : voxels_of(mesh)) {
    CHECK(std::abs(color.g - 188) <= 6);
  }
  // Two triangles in a red and a blue half, whose corners lie in the same voxels.
  TriangleMesh halves;
  for (const double from : {0.0, 1.0}) {
    const auto first = static_cast<std::uint32_t>(halves.positions.size());
    halves.positions.insert(halves.positions.end(),
                            {{from, 0, 0}, {from + 1, 0, 0}, {from + 1, 2, 0}, {from, 2, 0}});
    halves.colors.insert(halves.colors.end(), 4, from == 0 ? kRed : kBlue);
    halves.triangles.push_back({first, first + 1, first + 2});
    halves.triangles.push_back({first, first + 2, first + 3});
  }
  CHECK(columns_of(halves) == "rrrrrrrrbbbbbbbb");
}

TEST_CASE("texture: at the border of a picture -> nothing of the opposite border, whatever its wrap mode") {
  constexpr Pixel kClearPixel{0, 0, 0, 0};
  for (const char* const mode : {"OPAQUE", "MASK", "BLEND"}) {
    for (const double reach : {2.05, 2.15, 2.25, 2.35, 2.45}) {  // its sides end in any part of a voxel
      std::map<Place, Rgb> clamped;
      for (const char* const wrap : {"33071", "10497"}) {
        CAPTURE(mode);
        CAPTURE(reach);
        Quad quad;
        quad.picture = png(2, 2, {kClearPixel, kBlackPixel, kRedPixel, kWhitePixel});
        quad.material = R"({"pbrMetallicRoughness":{"baseColorTexture":{"index":0}},"alphaMode":")" +
                        std::string(mode) + R"("})";
        quad.texture = R"({"source":0,"sampler":0})";
        quad.more = R"("samplers":[{"wrapS":)" + std::string(wrap) + R"(,"wrapT":)" + wrap + R"(}],)";
        Source source = quad.source();
        auto& mesh = std::get<TriangleMesh>(source);
        mesh.positions.push_back({reach, reach, 0});
        mesh.texcoords.push_back({0, 0});
        mesh.triangles.push_back({4, 4, 4});
        mesh.surface_of.push_back(0);
        const auto voxels = voxels_of(source, 5);
        clamped = clamped.empty() ? voxels : clamped;
        CHECK(voxels == clamped);
      }
      CHECK(clamped.size() > 60);
    }
  }
}

TEST_CASE("gltf: alpha -> with MASK and BLEND what is clear is nothing, with OPAQUE it means nothing") {
  Quad quad;
  quad.picture = png(4, 1, {{255, 0, 0, 0}, {255, 0, 0, 100}, {255, 0, 0, 160}, kRedPixel});
  const auto with = [&](const std::string& members, const std::string& alpha = "1") {
    quad.material = R"({"pbrMetallicRoughness":{"baseColorFactor":[1,1,1,)" + alpha +
                    R"(],"baseColorTexture":{"index":0}})" + members + "}";
    return columns_of(quad.source());
  };
  CHECK(with("") == "rrrrrrrrrrrrrrrr");
  CHECK(with("", "0") == "rrrrrrrrrrrrrrrr");
  CHECK(with(R"(,"alphaMode":"MASK")") == "        rrrrrrrr");
  CHECK(with(R"(,"alphaMode":"MASK","alphaCutoff":0.3)") == "    rrrrrrrrrrrr");
  CHECK(with(R"(,"alphaMode":"MASK")", "0.6") == "            rrrr");
  CHECK(notes_hold(quad.source(), "BLEND") == false);
  CHECK(with(R"(,"alphaMode":"BLEND")") == "    rrrrrrrrrrrr");
  CHECK(notes_hold(quad.source(), "of 1 blended material (BLEND)"));
  const auto fault = [&](const std::string& material) {
    quad.material = material;
    return error_of(read_gltf, quad.glb());
  };
  CHECK(contains(fault(R"({"alphaMode":"BLEND","pbrMetallicRoughness":{"baseColorFactor":[1,0,0,0]}})"),
                 "clear"));
  CHECK(contains(fault(R"({"alphaMode":"MASK","alphaCutoff":"x"})"), "alphaCutoff"));
  quad.attributes = R"(,"COLOR_0":2)";
  quad.colors = {1, 1, 1, 0, 1, 1, 1, 0, 1, 1, 1, 0, 1, 1, 1, 1};
  quad.material = R"({"alphaMode":"BLEND"})";
  CHECK(std::get<TriangleMesh>(quad.source()).triangles.size() == 1);
}

TEST_CASE(
    "gltf, obj: light that materials give off -> voxels of that light, by its picture, the others as they "
    "were") {
  /// The first letters of the columns' colours, capital where they glow; and the power of what glows, or 0.
  using Glow = std::pair<std::string, double>;
  const auto glow_of = [](const Source& source) {
    const auto& mesh = std::get<TriangleMesh>(source);
    const PaletteMap colors(mesh_colors(mesh, 4, false));
    Glow glow(std::string(16, ' '), 0);
    voxelise(mesh, 4, false, &colors, [&](const UnitPoint& at, int, std::uint8_t material) {
      const Material& entry = colors.palette()[material];
      const bool glows = entry.kind == SurfaceKind::kEmit && entry.emission == 1;
      glow.second = glows ? std::exp2(entry.flux) : glow.second;
      const std::size_t letter = entry.color == kRed     ? 0
                                 : entry.color == kGreen ? 1
                                 : entry.color == kBlue  ? 2
                                                         : 3;
      glow.first[static_cast<std::size_t>(at[0])] = (glows ? "RGB?" : "rgb?")[letter];
    });
    return glow;
  };
  const std::string by_picture = R"(,"emissiveTexture":{"index":0})";
  const auto strong = [](const std::string& strength) {
    return R"(,"extensions":{"KHR_materials_emissive_strength":{"emissiveStrength":)" + strength + "}}";
  };
  const std::string none = "rrrrrrrrbbbbbbbb";
  const std::string green = "GGGGGGGGGGGGGGGG";
  const auto light = [](const std::string& factor) { return R"(,"emissiveFactor":)" + factor; };
  const auto glow_with = [&](const std::string& members) {
    Quad quad;
    quad.material = R"({"pbrMetallicRoughness":{"baseColorTexture":{"index":0}})" + members + "}";
    return glow_of(quad.source());
  };
  for (const auto& [each_members, glow] : std::vector<std::pair<std::string, Glow>>{
           {"", {none, 0}},
           {light("[0, 1, 0]"), {green, 1}},
           {light("[0, 1, 0]") + strong("4"), {green, 4}},
           {light("[0.0001, 1, 0]") + strong("10000000"), {green, 256}},  // its hue stays
           {light("[1, 0, 0]") + by_picture, {"RRRRRRRRbbbbbbbb", 1}},
           {light("[0.05, 0, 0]"), {none, 0}},
           {light("[0, 0, 0]") + by_picture, {none, 0}}}) {
    const auto& members = each_members;
    CAPTURE(members);
    CHECK(glow_with(members) == glow);
  }
  CHECK(glow_with(light("[0.9, 0.9, 0.9]")).first == none);  // less than it reflects
  // Its picture lies elsewhere than the colour's: it is not drawn, and that is said.
  Quad apart;
  apart.material = R"({"pbrMetallicRoughness":{"baseColorTexture":{"index":0}},"emissiveFactor":[1,1,1],)"
                   R"("emissiveTexture":{"index":0,"texCoord":1}})";
  CHECK(glow_of(apart.source()).first == none);
  CHECK(notes_hold(apart.source(), "the light of material 0 is not drawn"));
  // A picture that has no place hides no light.
  Quad lost;
  lost.material =
      R"({"pbrMetallicRoughness":{"baseColorTexture":{"index":0,"texCoord":5}},"emissiveFactor":[0,1,0]})";
  CHECK(glow_of(lost.source()).first == green);
  // Nothing but light, without any picture or coordinates.
  Quad plain;
  plain.material = R"({"emissiveFactor":[0,0,1]})";
  CHECK(glow_of(plain.source()).first == "BBBBBBBBBBBBBBBB");

  TemporaryFolder folder;
  const std::string quad = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
  folder.write("red.png", red_blue());
  folder.write("a.mtl", "newmtl a\nKd 1 0 0\nKe 0 0 2\n");
  const std::string plain_face = quad + "usemtl a\nf 1 2 3 4\n";
  CHECK(glow_of(read_beside(folder, "a.obj", plain_face)) == Glow{"BBBBBBBBBBBBBBBB", 2});
  folder.write("a.mtl", "newmtl a\nKd 0 0 0\nKe 1\n");
  CHECK(glow_of(read_beside(folder, "a.obj", plain_face)) == Glow{"????????????????", 1});
  folder.write("a.mtl", "newmtl a\nKd 0 1 0\nKe 1 0 0\nmap_Ke red.png\n");
  const std::string places = "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl a\nf 1/1 2/2 3/3 4/4\n";
  CHECK(glow_of(read_beside(folder, "a.obj", quad + places)).first == "RRRRRRRRgggggggg");
}

TEST_CASE("texture: clear beside a mesh's part of it -> no voxel of the mesh's rims is lost") {
  Quad quad;
  std::vector<Pixel> pixels(64, {255, 0, 0, 0});
  for (const std::size_t i :
       {18U, 19U, 20U, 21U, 26U, 27U, 28U, 29U, 34U, 35U, 36U, 37U, 42U, 43U, 44U, 45U}) {
    pixels[i] = kRedPixel;
  }
  quad.picture = png(8, 8, pixels);
  quad.places = {0.25F, 0.75F, 0.75F, 0.75F, 0.75F, 0.25F, 0.25F, 0.25F};
  quad.material = R"({"alphaMode":"MASK","pbrMetallicRoughness":{"baseColorTexture":{"index":0}}})";
  Source source = quad.source();
  auto& mesh = std::get<TriangleMesh>(source);
  const auto voxels = [&] {
    std::vector<std::array<std::int32_t, 3>> all;
    voxelise(mesh, 5, false, nullptr, [&](const UnitPoint& at, int, std::uint8_t) { all.push_back(at); });
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
  };
  const auto lost = [&] {
    const auto drawn = voxels();
    mesh.surfaces[1].cutoff = 0;
    const auto whole = voxels();
    mesh.surfaces[1].cutoff = 0.5;
    return whole.size() - drawn.size();
  };
  // Standing on a corner: beside its edges lie middles that are over no triangle.
  mesh.positions = {{1, 0, 0}, {2, 1.1, 0}, {1, 2, 0}, {0, 0.9, 0}};
  CHECK(lost() == 0);
  // A roof, both sides with the same part of the picture, which ends at the ridge.
  mesh.positions = {{0, 0, 0}, {0.4, 0, 3}, {0.3, 2, 3.2}, {0.6, 0, 0}};
  mesh.texcoords = {{0.75F, 0.25F}, {0.25F, 0.25F}, {0.75F, 0.75F}, {0.25F, 0.25F}};
  CHECK(lost() == 0);
}

TEST_CASE("texture: what is no picture, damaged, too large, not there -> the shape, and a note") {
  Quad quad;
  const auto note = [&](const std::string& picture) {
    quad.picture = picture;
    const Source source = quad.source();
    CHECK(std::get<TriangleMesh>(source).triangles.size() == 2);
    CHECK(std::get<TriangleMesh>(source).surfaces.empty());
    const Notes notes = notes_of(source);
    REQUIRE(notes.size() == 1);
    CHECK(notes[0].size() < 300);
    return notes[0];
  };
  CHECK(contains(note("GIF89a"), "is no PNG, JPEG or WebP"));
  CHECK(contains(note("\xABKTX 20\xBB\r\n\x1A\n"), "KTX"));
  CHECK(contains(note(std::string("RIFF\0\0\0\0WEBPVP8 ", 16)), "is no PNG, JPEG or WebP"));
  CHECK(contains(note(webp(2, 1, {kRedPixel, kBluePixel}).substr(0, 30)), "damaged"));
  CHECK(contains(note(red_blue().substr(0, 50)), "damaged"));
  std::string large = red_blue();
  large.replace(16, 8, std::string("\0\0\x40\0\0\0\x40\0", 8));  // 16,384 a side
  CHECK(contains(note(large), "16384 x 16384 pixels, too many for a file of"));
  // One pixel, and 16 MB behind it.
  const std::string bomb = deflated(std::string(std::size_t{16} << 20, '\0'), 15);
  const std::string one = png(1, 1, {kRedPixel}).substr(0, 33) + thimble::tests::big(bomb.size(), 4);
  const std::string end = std::string(8, '\0') + "IEND" + std::string(4, '\0');
  CHECK(contains(note(one + "IDAT" + bomb + end), "damaged"));
  quad.texture = "{}";
  CHECK(contains(note(red_blue()), "KTX2"));
}

TEST_CASE("obj: materials with pictures -> their colours; names with blanks, options, several libraries") {
  const TemporaryFolder folder;
  const std::string square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";
  const std::string face = "f 1/1 2/2 3/3 4/4\n";
  folder.write("my photo 2.png", red_blue());
  folder.write("mask.png", png(2, 1, {{150, 150, 150, 255}, {100, 100, 100, 255}}));
  folder.write("cut.png", png(2, 1, {{255, 0, 0, 255}, {255, 0, 0, 60}}));
  folder.write("a.mtl", "newmtl a\nKd 1 1 1\nmap_Kd -s 1 1 1 -clamp on my photo 2.png\n");
  folder.write("b.mtl", "newmtl b\nmap_Kd C:\\pictures\\my photo 2.png\nmap_d mask.png\n");
  folder.write("c d.mtl",
               "newmtl c\nKd 0 0 0\nmap_Kd my photo 2.png\nnewmtl dim\nKd 0.5 1 1\nmap_Kd my photo 2.png\n"
               "newmtl gone\nKd 0 1 0\nmap_Kd none.png\nnewmtl cut\nmap_Kd cut.png\nmap_d cut.png\n");
  const auto read = [&](const std::string& text) { return read_beside(folder, "x.obj", text); };
  const std::string libraries = "mtllib a.mtl b.mtl c d.mtl\n" + square;
  CHECK(columns_of(read(libraries + "usemtl a\n" + face)) == "rrrrrrrrbbbbbbbb");
  CHECK(columns_of(read(libraries + "usemtl b\n" + face)) == "rrrrrrrr        ");
  CHECK(columns_of(read(libraries + "usemtl c\n" + face)) == "rrrrrrrrbbbbbbbb");
  CHECK(columns_of(read(libraries + "usemtl cut\n" + face)) == "rrrrrrrr        ");  // by its own alpha
  CHECK(notes_of(read(libraries + "usemtl c\n" + face)).empty());
  CHECK(voxels_of(read(libraries + "usemtl dim\n" + face)).at({2, 2}) == Rgb{128, 0, 0});
  const Source gone = read(libraries + "usemtl gone\n" + face);
  CHECK(std::get<TriangleMesh>(gone).face_colors == std::vector<Rgb>{kGreen, kGreen});
  CHECK(notes_hold(gone, "the picture 'none.png' is not drawn: it cannot be opened"));
  CHECK(notes_hold(read("mtllib a.mtl none.mtl\n" + square + "usemtl a\n" + face), "'none.mtl'"));
  // Corners by negative numbers, before their coordinates, out of range, of faces without any.
  CHECK(columns_of(read(libraries + "usemtl a\nf 1/-4 2/-3 3/-2 4/-1\n")) == "rrrrrrrrbbbbbbbb");
  CHECK(columns_of(read("mtllib a.mtl\nusemtl a\n" + face + square)) == "rrrrrrrrbbbbbbbb");
  CHECK(columns_of(read(libraries + "usemtl a\nf 1/1 2/9 3/3 4/4\n")).find('?') != std::string::npos);
  CHECK(notes_hold(read(libraries + "usemtl a\nf 1 2 3 4\n"), "no face has texture coordinates"));
  const auto both = voxels_of(read(libraries + "usemtl gone\nf 1/1 2/2 3/3\nusemtl a\nf 1/1 3/3 4/4\n"));
  CHECK(both.at({14, 2}) == kGreen);
  CHECK(both.at({2, 14}) == kRed);
  // Where vertices have colours, too, the picture is what was meant.
  std::string colored = "mtllib a.mtl\nusemtl a\n" + square + face;
  for (std::size_t at = 0; (at = colored.find("\nv ", at)) != std::string::npos;) {
    at = colored.find('\n', at + 1);
    colored.insert(at, " 0 1 0");
  }
  CHECK(columns_of(read(colored)) == "rrrrrrrrbbbbbbbb");
}

TEST_CASE("obj: a concave polygon with a picture -> each ear with its own part of it") {
  const TemporaryFolder folder;
  folder.write("p.png", red_blue());
  folder.write("m.mtl", "newmtl m\nmap_Kd p.png\n");
  std::string text = "mtllib m.mtl\nusemtl m\n";
  std::string face = "f";
  int number = 1;
  for (const auto& [x, y] :
       std::vector<std::array<int, 2>>{{0, 0}, {8, 0}, {8, 8}, {6, 8}, {6, 2}, {2, 2}, {2, 8}, {0, 8}}) {
    text += "v " + std::to_string(x) + " " + std::to_string(y) + " 0\nvt " + std::to_string(x / 8.0) + " " +
            std::to_string(y / 8.0) + "\n";
    face += " " + std::to_string(number) + "/" + std::to_string(number);
    ++number;
  }
  const Source source = read_beside(folder, "u.obj", text + face + "\n");
  CHECK(columns_of(source) == "rrrrrrrrbbbbbbbb");
  CHECK(voxels_of(source).count({8, 12}) == 0);
}

TEST_CASE(
    "ply: TextureFile with coordinates of vertices, of corners, with several pictures -> their colours") {
  const TemporaryFolder folder;
  folder.write("a b.png", red_blue());
  folder.write("c.png", png(1, 1, {kGreenPixel}));
  const auto head = [](const std::string& comments, const std::string& vertex, const std::string& face) {
    return "ply\nformat ascii 1.0\n" + comments + "element vertex 4\nproperty float x\nproperty float y\n" +
           "property float z\n" + vertex + "element face 2\nproperty list uchar int vertex_indices\n" + face +
           "end_header\n";
  };
  const auto read = [&](const std::string& text) { return read_beside(folder, "x.ply", text); };
  const std::string picture = "comment TextureFile  a b.png \n";
  for (const char* names : {"u v", "s t", "texture_u texture_v"}) {
    const std::string both = names;
    const std::string vertex = "property float " + both.substr(0, both.find(' ')) + "\nproperty float " +
                               both.substr(both.find(' ') + 1) + "\n";
    CHECK(columns_of(read(head(picture, vertex, "") +
                          "0 0 0 0 0\n1 0 0 1 0\n1 1 0 1 1\n0 1 0 0 1\n3 0 1 2\n3 0 2 3\n")) ==
          "rrrrrrrrbbbbbbbb");
  }
  const std::string square = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";
  const std::string corners = "property list uchar float texcoord\n";
  CHECK(columns_of(read(head(picture, "", corners) + square +
                        "3 0 1 2 6 0 0 1 0 1 1\n3 0 2 3 6 0 0 1 1 0 1\n")) == "rrrrrrrrbbbbbbbb");
  const auto several =
      voxels_of(read(head(picture + "comment TextureFile c.png\n", "", corners + "property int texnumber\n") +
                     square + "3 0 1 2 6 0 0 1 0 1 1 1\n3 0 2 3 6 0 0 1 1 0 1 0\n"));
  CHECK(several.at({14, 2}) == kGreen);
  CHECK(several.at({2, 14}) == kRed);
  CHECK(notes_hold(read(head("comment TextureFile none.png\n", "", corners) + square +
                        "3 0 1 2 6 0 0 1 0 1 1\n3 0 2 3 6 0 0 1 1 0 1\n"),
                   "'none.png'"));
  CHECK(notes_hold(read(head(picture, "", "") + square + "3 0 1 2\n3 0 2 3\n"), "no texture coordinates"));
}
