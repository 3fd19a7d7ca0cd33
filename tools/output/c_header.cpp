#include "output/c_header.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdio>

#include "output/units.h"
#include "thimble/light/scene.h"

namespace thimble::tools {
namespace {

constexpr std::size_t kMostIdentifier = 63;  // what C99 tells apart
constexpr std::size_t kLineWidth = 100;

// Keywords of C to C23 and C++ to C++20, and the names that <stdint.h> takes.
constexpr std::array<std::string_view, 100> kTaken{
    "alignas",  "alignof",      "and",      "asm",      "auto",     "bool",      "break",     "case",
    "catch",    "char",         "class",    "concept",  "const",    "consteval", "constexpr", "constinit",
    "continue", "decltype",     "default",  "delete",   "do",       "double",    "else",      "enum",
    "explicit", "export",       "extern",   "false",    "float",    "for",       "friend",    "goto",
    "if",       "inline",       "int",      "long",     "mutable",  "namespace", "new",       "noexcept",
    "not",      "nullptr",      "operator", "or",       "private",  "protected", "public",    "register",
    "requires", "restrict",     "return",   "short",    "signed",   "sizeof",    "static",    "struct",
    "switch",   "template",     "this",     "throw",    "true",     "try",       "typedef",   "typeid",
    "typename", "typeof",       "union",    "unsigned", "using",    "virtual",   "void",      "volatile",
    "while",    "xor",          "bitand",   "bitor",    "compl",    "and_eq",    "or_eq",     "xor_eq",
    "not_eq",   "int8_t",       "int16_t",  "int32_t",  "int64_t",  "uint8_t",   "uint16_t",  "uint32_t",
    "uint64_t", "size_t",       "wchar_t",  "char8_t",  "char16_t", "char32_t",  "co_await",  "co_return",
    "co_yield", "thread_local", "main",     "intptr_t"};

std::string capitals(std::string_view text) {
  std::string out(text);
  std::transform(out.begin(), out.end(), out.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return out;
}

// A name that can stand in a comment, whatever it was: nothing that ends the comment or joins lines.
std::string for_comment(ConstBytes name) {
  std::string out;
  for (const std::uint8_t byte : name) {
    const bool plain = std::isalnum(byte) != 0 ||
                       std::string_view(" ._,:-+=()").find(static_cast<char>(byte)) != std::string_view::npos;
    out += plain ? static_cast<char>(byte) : '_';
  }
  return out;
}

}  // namespace

bool is_identifier(std::string_view text) {
  if (text.empty() || text.size() > kMostIdentifier ||
      std::isalpha(static_cast<unsigned char>(text[0])) == 0 || text.find("__") != std::string_view::npos ||
      std::find(kTaken.begin(), kTaken.end(), text) != kTaken.end()) {
    return false;
  }
  return std::all_of(text.begin(), text.end(),
                     [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; });
}

std::string c_header_text(const BakedScene& scene, std::string_view identifier) {
  const std::string name(identifier);
  const std::string prefix = capitals(identifier) + "_";
  const CompactTree& tree = scene.tree();
  std::string text = "/* A scene for Thimble, made by `thimble bake`";
  if (const ConstBytes made_from = scene.section(SectionKind::kName); !made_from.empty()) {
    text += " from " + for_comment(made_from);
  }
  text += ". Do not edit. */\n#ifndef " + prefix + "H\n#define " + prefix + "H\n\n#include <stdint.h>\n\n";
  const auto define = [&](const char* fact, const std::string& value) {
    text += "#define " + prefix + fact + " " + value + "\n";
  };
  text += "/* What it is, for choosing when a program is compiled. */\n";
  define("VERSION", std::to_string(kBakedVersion));
  define("BYTES", std::to_string(scene.bytes().size) + "u");
  define("CRC32", "0x" + crc_text(scene.crc32()) + "u");
  define("DEPTH", std::to_string(tree.level()));
  // A preprocessor computes in 64 bits; the suffix keeps a compiler of C90 quiet about large constants.
  define("VOXELS", std::to_string(tree.voxel_count()) + (tree.voxel_count() > UINT32_MAX ? "ull" : "ul"));
  define("NODES", std::to_string(tree.node_count()) + "ul");
  define("MANY_MATERIALS", tree.many_materials() ? "1" : "0");
  define("MERGED_BLOCKS", tree.merged() ? "1" : "0");
  define("PALETTE_COLORS", std::to_string(scene.palette().size));
  define("HAS_CAMERA", scene.has_camera() ? "1" : "0");
  define("IS_PERSPECTIVE", scene.has_camera() && scene.camera().is_perspective ? "1" : "0");
  define("IS_ORTHOGRAPHIC", scene.has_camera() && !scene.camera().is_perspective ? "1" : "0");
  BakedLighting lighting;
  if (BakedLighting::open(scene.section(SectionKind::kLighting), tree.level(), &lighting) != Status::kOk) {
    lighting.effects = Effect::kNone;  // baked without
  }
  std::array<char, 16> effects{};
  std::snprintf(effects.data(), effects.size(), "0x%03xu", static_cast<unsigned>(lighting.effects));
  // The bits are those of thimble/light/scene.h; words for a person.
  std::string names;
  for (int bit = 0; bit < Effect::kCount; ++bit) {
    const EffectSet effect = EffectSet{1} << bit;
    names += (lighting.effects & effect) != 0 ? std::string(" ") + effect_name(effect) : "";
  }
  define("EFFECTS", effects.data() + (names.empty() ? "" : " /*" + names + " */"));
  std::size_t lamps = 0;
  for (const Light& light : lighting.scene.lights) {
    lamps += light.is_point ? 1 : 0;
  }
  define("LAMPS", std::to_string(lamps));
  define("HAS_BRICK_MAP", scene.section(SectionKind::kBrickMap).empty() ? "0" : "1");
  text +=
      "\n/* Aligned, so that a chip that wants whole words reads them at once. Constant, so that it stays in "
      "flash. */\n"
      "#if defined(__cplusplus)\nalignas(8)\n"
      "#elif defined(__STDC_VERSION__) && __STDC_VERSION__ >= 201112L\n_Alignas(4)\n"
      "#elif defined(__GNUC__)\n__attribute__((aligned(8)))\n#endif\n"
      "static const uint8_t " +
      name + "[" + prefix + "BYTES] = {\n";
  std::string line;
  for (const std::uint8_t byte : scene.bytes()) {
    const std::string number = std::to_string(byte) + ",";
    if (line.size() + number.size() > kLineWidth) {
      text += line + "\n";
      line.clear();
    }
    line += number;
  }
  text += line + "\n};\n\n#endif\n";
  return text;
}

}  // namespace thimble::tools
