/// What the `.vox` reader is made of: the pieces of its chunks, its scene graph.
#pragma once

#include <charconv>
#include <optional>

#include "readers/source.h"

namespace thimble::tools {

/// "XYZI chunk at byte offset 44": the place that errors name. Bytes of an id that do not print become `?`.
inline std::string vox_place(std::string_view id, std::uint64_t offset) {
  std::string place;
  for (const char letter : id) {
    place += letter >= ' ' && letter <= '~' ? letter : '?';
  }
  return concat(place, " chunk at byte offset ", offset);
}

/// A dictionary: the number of entries, then a key and a value each, which begin with their lengths. Calls `entry(key, value)` for each; the
/// count is not trusted, each string must be there.
template <class Entry>
void vox_dictionary(ByteReader& reader, const Entry& entry) {
  const std::uint32_t count = reader.u32();
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::string_view key = reader.text(reader.u32());
    const std::string_view value = reader.text(reader.u32());
    entry(key, value);
  }
}

/// The number that is all of `text`, or nothing. Independent of the locale.
template <class Number>
std::optional<Number> vox_number(std::string_view text) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || end != text.data() + text.size()) {
    return std::nullopt;
  }
  return number;
}

/// MagicaVoxel's palette for files without RGBA. Entry 0 is the unused one and stays white.
Palette vox_default_palette();

// The scene graph: nTRN, nGRP and nSHP nodes, layers, and where they put the models.
//
// Node 0 is the root. An nTRN turns and moves its one child, an nGRP holds children, an nSHP shows a model.
// Nodes may be shared, so the graph is a directed one without cycles rather than a tree.

/// A rotation or mirror of the lattice, then a translation:
/// world[i] = sign[i] * local[axis[i]] + translation[i].
struct VoxTransform {
  std::array<std::uint8_t, 3> axis{0, 1, 2};  ///< a permutation
  std::array<std::int8_t, 3> sign{1, 1, 1};   ///< 1 or -1
  std::array<std::int32_t, 3> translation{};

  /// This transform after `child`.
  VoxTransform after(const VoxTransform& child) const;
};

/// The chunks of nodes, by `VoxScene::Kind`.
inline constexpr std::array<std::string_view, 3> kVoxNodes{"nTRN", "nGRP", "nSHP"};

/// Collects nodes while chunks are read, then walks them.
class VoxScene {
 public:
  /// Each takes the content of one chunk. @throws InputError for what a node alone shows to be wrong.
  /// @param kind  in `kVoxNodes`
  void add_node(ByteReader& chunk, std::size_t kind, std::uint64_t offset);
  void add_layer(ByteReader& chunk);

  bool empty() const { return nodes_.empty(); }
  /// The frames that something changes in, ascending; the scene is the same from each to the next. Call once
  /// all nodes are in.
  const std::vector<std::int64_t>& frames();

  /// Called for each visible model, in order: the model's number as in the file (it may be none), where it is
  /// put, and the byte offset of the nSHP chunk for errors.
  using Place = std::function<void(std::uint32_t model, const VoxTransform& transform, std::uint64_t offset)>;
  /// Walks from node 0, depth first, with a stack of its own: depth is bounded by the number of nodes, work
  /// by `kVoxVisitLimit`. Hidden nodes, and nodes of hidden layers, are left out with all below them. A node
  /// is as its last key up to `frame` says, as its first where none comes so early.
  /// @return how many nodes were entered
  /// @throws InputError  a missing root, child or unique id; a cycle; a limit on translations or nodes entered
  std::uint32_t place_models(std::int64_t frame, const Place& place);

 private:
  enum class Kind : std::uint8_t { kTransform, kGroup, kShape };
  struct Node {
    std::int32_t id = 0;
    Kind kind = Kind::kTransform;
    bool hidden = false;
    bool on_path = false;           ///< the walk is inside it now
    std::int32_t layer = -1;        ///< nTRN only; -1 is none
    std::uint64_t offset = 0;       ///< of the chunk, for errors
    std::uint32_t first_child = 0;  ///< in `children_`
    std::uint32_t child_count = 0;
    ByteReader keys{{}};  ///< of an nTRN its frames, of an nSHP its models
    std::uint32_t key_count = 0;
  };

  /// The keys that come next, held to what `read` says of them.
  template <class Read>
  void take_keys(ByteReader& chunk, const Read& read, Node* node);
  void sort_nodes();
  std::uint32_t find(std::int32_t id) const;

  std::vector<Node> nodes_;
  std::vector<std::int32_t> children_;       ///< ids
  std::vector<std::int32_t> hidden_layers_;  ///< ids
  std::vector<std::int64_t> frames_;
  bool is_sorted_ = false;
};

}  // namespace thimble::tools
