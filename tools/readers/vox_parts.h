/// What the `.vox` reader is made of: the pieces of its chunks, its scene graph.
#pragma once

#include <algorithm>
#include <optional>

#include "output/units.h"
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
  VoxTransform after(const VoxTransform& child) const {
    VoxTransform both;
    for (std::size_t i = 0; i < 3; ++i) {
      both.axis[i] = child.axis[axis[i]];
      both.sign[i] = static_cast<std::int8_t>(sign[i] * child.sign[axis[i]]);
      both.translation[i] = sign[i] * child.translation[axis[i]] + translation[i];
    }
    return both;
  }
};

/// The chunks of nodes, by `VoxScene::Kind`.
inline constexpr std::array<std::string_view, 3> kVoxNodes{"nTRN", "nGRP", "nSHP"};

/// Collects nodes while chunks are read, then walks them.
class VoxScene {
 public:
  /// Each takes the content of one chunk. @throws InputError for what a node alone shows to be wrong.
  /// @param kind  in `kVoxNodes`
  void add_node(ByteReader& chunk, std::size_t kind, std::uint64_t offset) {
    Node node;
    node.kind = static_cast<Kind>(kind);
    node.offset = offset;
    node.id = chunk.i32();
    chunk.fail_if(node.id < 0, "node id ", node.id, " is negative");
    node.hidden = is_hidden(chunk);
    node.first_child = static_cast<std::uint32_t>(children_.size());
    if (node.kind == Kind::kTransform) {
      children_.push_back(chunk.i32());
      chunk.skip(4);  // reserved
      node.layer = chunk.i32();
      take_keys(chunk, read_transform, &node);
    } else if (node.kind == Kind::kShape) {
      take_keys(chunk, read_model, &node);
    } else {
      const std::uint32_t count = chunk.u32();
      chunk.fail_if(chunk.remaining() / 4 < count, count, " children do not fit the ", chunk.remaining(),
                    " bytes that are left");
      for (std::uint32_t i = 0; i < count; ++i) {
        children_.push_back(chunk.i32());
      }
    }
    node.child_count = static_cast<std::uint32_t>(children_.size()) - node.first_child;
    nodes_.push_back(node);
  }
  void add_layer(ByteReader& chunk) {
    const std::int32_t id = chunk.i32();
    if (is_hidden(chunk) && id >= 0) {  // -1 stands for no layer
      hidden_layers_.push_back(id);
    }
  }

  bool empty() const { return nodes_.empty(); }
  /// The frames that something changes in, ascending; the scene is the same from each to the next. Call once
  /// all nodes are in.
  const std::vector<std::int64_t>& frames() {
    std::sort(frames_.begin(), frames_.end());
    frames_.erase(std::unique(frames_.begin(), frames_.end()), frames_.end());
    return frames_;
  }

  /// Called for each visible model, in order: the model's number as in the file (it may be none), where it is
  /// put, and the byte offset of the nSHP chunk for errors.
  using Place = std::function<void(std::uint32_t model, const VoxTransform& transform, std::uint64_t offset)>;
  /// Walks from node 0, depth first, with a stack of its own: depth is bounded by the number of nodes, work
  /// by `kVoxVisitLimit`. Hidden nodes, and nodes of hidden layers, are left out with all below them. A node
  /// is as its last key up to `frame` says, as its first where none comes so early.
  /// @return how many nodes were entered
  /// @throws InputError  a missing root, child or unique id; a cycle; a limit on translations or nodes entered
  std::uint32_t place_models(std::int64_t frame, const Place& place) {
    sort_nodes();
    struct Step {
      std::uint32_t node;
      std::uint32_t next_child;
      VoxTransform world;
    };
    std::vector<Step> path;
    std::uint32_t visits = 0;

    const auto fail_if = [](bool is_wrong, const Node& node, const auto&... sentence) {
      if (is_wrong) {
        throw InputError(vox_place(kVoxNodes[static_cast<std::size_t>(node.kind)], node.offset), ": ",
                         sentence...);
      }
    };
    const auto enter = [&](std::uint32_t index, const VoxTransform& parent) {
      Node& node = nodes_[index];
      fail_if(++visits > kVoxVisitLimit, node, "the scene graph has more than the limit of ", kVoxVisitLimit,
              " nodes, shared ones counted each time");
      fail_if(node.on_path, node, "node ", node.id, " contains itself: the scene graph has a cycle");
      if (node.hidden || std::binary_search(hidden_layers_.begin(), hidden_layers_.end(), node.layer)) {
        return;
      }
      if (node.kind == Kind::kShape) {
        if (node.key_count > 0) {
          place(value_at(node.keys, node.key_count, frame, std::uint32_t{0}, read_model), parent,
                node.offset);
        }
        return;
      }
      const VoxTransform world =
          node.kind == Kind::kTransform
              ? parent.after(value_at(node.keys, node.key_count, frame, VoxTransform{}, read_transform))
              : parent;
      for (const std::int32_t coordinate : world.translation) {
        fail_if(coordinate < -kVoxTranslationLimit || coordinate > kVoxTranslationLimit, node,
                "nested translations add up to ", coordinate, ", beyond the limit of +-",
                kVoxTranslationLimit);
      }
      node.on_path = true;
      path.push_back({index, 0, world});
    };

    const std::uint32_t root = find(0);
    fail_if(root == kNoNode, nodes_.front(), "the scene graph has no root, node 0");
    enter(root, VoxTransform{});
    while (!path.empty()) {
      Step& step = path.back();
      Node& node = nodes_[step.node];
      if (step.next_child == node.child_count) {
        node.on_path = false;
        path.pop_back();
        continue;
      }
      const std::int32_t id = children_[node.first_child + step.next_child];
      ++step.next_child;
      const std::uint32_t child = find(id);
      fail_if(child == kNoNode, node, "child ", id, " is no node of this file");
      const VoxTransform world = step.world;  // `enter` may move the path
      enter(child, world);
    }
    return visits;
  }

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
  void take_keys(ByteReader& chunk, const Read& read, Node* node) {
    node->key_count = chunk.u32();
    node->keys = chunk;
    for (std::uint32_t i = 0; i < node->key_count; ++i) {
      std::int64_t frame = 0;
      read(chunk, &frame);
      if (frames_.empty() || frames_.back() != frame) {
        frames_.push_back(frame);
      }
    }
  }
  void sort_nodes() {
    if (std::exchange(is_sorted_, true)) {
      return;
    }
    // By id, and by place in the file among equals, so that the error names the second of two.
    std::stable_sort(nodes_.begin(), nodes_.end(), [](const Node& a, const Node& b) { return a.id < b.id; });
    for (std::size_t i = 1; i < nodes_.size(); ++i) {
      if (nodes_[i].id == nodes_[i - 1].id) {
        throw InputError(vox_place(kVoxNodes[static_cast<std::size_t>(nodes_[i].kind)], nodes_[i].offset),
                         ": node id ", nodes_[i].id, " is already that of the node at byte offset ",
                         nodes_[i - 1].offset);
      }
    }
    std::sort(hidden_layers_.begin(), hidden_layers_.end());
  }
  /// Index of the node with that id, `kNoNode` without one. `nodes_` is sorted.
  std::uint32_t find(std::int32_t id) const {
    const auto found =
        std::lower_bound(nodes_.begin(), nodes_.end(), id,
                         [](const Node& node, std::int32_t wanted) { return node.id < wanted; });
    return found != nodes_.end() && found->id == id ? static_cast<std::uint32_t>(found - nodes_.begin())
                                                    : kNoNode;
  }

  /// Largest translation, alone or summed over nested groups, on any axis and in either direction.
  static constexpr std::int32_t kVoxTranslationLimit = 1 << 24;
  /// Most scene graph nodes entered while placing them, for shared groups that hold nothing.
  static constexpr std::uint32_t kVoxVisitLimit = 1 << 20;
  static constexpr std::uint32_t kNoNode = UINT32_MAX;

  /// `_t`: three whole numbers with blanks between them.
  static std::array<std::int32_t, 3> parse_translation(std::string_view text, const ByteReader& chunk) {
    std::array<std::int32_t, 3> translation{};
    std::string_view rest = text;
    for (std::int32_t& coordinate : translation) {
      rest.remove_prefix(std::min(rest.find_first_not_of(' '), rest.size()));
      const std::string_view word = rest.substr(0, rest.find(' '));
      const std::optional<std::int32_t> number = number_in<std::int32_t>(word);
      chunk.fail_if(!number, "translation \"_t\" is not three whole numbers of 32 bits");
      chunk.fail_if(*number < -kVoxTranslationLimit || *number > kVoxTranslationLimit, "translation ",
                    *number, " is beyond the limit of +-", kVoxTranslationLimit);
      coordinate = *number;
      rest.remove_prefix(word.size());
    }
    chunk.fail_if(rest.find_first_not_of(' ') != std::string_view::npos,
                  "translation \"_t\" is not three whole numbers of 32 bits");
    return translation;
  }

  /// `_r`: a signed permutation matrix in a byte, written in decimal.
  ///
  ///     bit   7   6      5      4      3 2     1 0
  ///           -   row 2  row 1  row 0  row 1   row 0
  ///               1: the row is negative | column of the row's entry; row 2 has the column left over
  static void parse_rotation(std::string_view text, const ByteReader& chunk, VoxTransform& transform) {
    const std::optional<std::uint8_t> packed = number_in<std::uint8_t>(text);
    const unsigned bits = packed.value_or(0xff);
    const unsigned row0 = bits & 3u;
    const unsigned row1 = bits >> 2 & 3u;
    chunk.fail_if(!packed || row0 == 3 || row1 == 3 || row0 == row1,
                  "rotation \"_r\" is not a byte that packs a rotation");
    transform.axis = {static_cast<std::uint8_t>(row0), static_cast<std::uint8_t>(row1),
                      static_cast<std::uint8_t>(3 - row0 - row1)};
    for (unsigned row = 0; row < 3; ++row) {
      transform.sign[row] = (bits >> (4 + row) & 1u) != 0 ? std::int8_t{-1} : std::int8_t{1};
    }
  }

  /// `_f`, the frame that an entry is for; frames are counted from 0 and the first is 0 when none is given.
  static std::int64_t parse_frame(std::string_view text, const ByteReader& chunk) {
    const std::optional<std::int64_t> frame = number_in<std::int64_t>(text);
    chunk.fail_if(!frame, "frame \"_f\" is not a whole number");
    return *frame;
  }

  /// An nTRN's next key; `frame` is where it begins to hold.
  static VoxTransform read_transform(ByteReader& keys, std::int64_t* frame) {
    VoxTransform transform;
    *frame = 0;
    vox_dictionary(keys, [&](std::string_view key, std::string_view value) {
      if (key == "_t") {
        transform.translation = parse_translation(value, keys);
      } else if (key == "_r") {
        parse_rotation(value, keys, transform);
      } else if (key == "_f") {
        *frame = parse_frame(value, keys);
      }
    });
    return transform;
  }

  /// An nSHP's next model.
  static std::uint32_t read_model(ByteReader& keys, std::int64_t* frame) {
    const std::uint32_t model = keys.u32();
    *frame = 0;
    vox_dictionary(keys, [&](std::string_view key, std::string_view value) {
      if (key == "_f") {
        *frame = parse_frame(value, keys);
      }
    });
    return model;
  }

  /// What `read` makes of the key that holds at `frame`: of keys in any order the last one up to it, or the first where none
  /// comes so early; of equal ones, the first in the file. `otherwise` without keys.
  template <class Value, class Read>
  static Value value_at(ByteReader keys, std::uint32_t count, std::int64_t frame, Value otherwise,
                        const Read& read) {
    std::optional<std::int64_t> best;
    for (std::uint32_t i = 0; i < count; ++i) {
      std::int64_t key = 0;
      const Value value = read(keys, &key);
      if (!best || (key <= frame ? *best > frame || key > *best : *best > frame && key < *best)) {
        best = key;
        otherwise = value;
      }
    }
    return otherwise;
  }

  /// What a node's or a layer's dictionary says of it.
  static bool is_hidden(ByteReader& chunk) {
    bool hidden = false;
    vox_dictionary(chunk, [&](std::string_view key, std::string_view value) {
      if (key == "_hidden") {
        hidden = value == "1";
      }
    });
    return hidden;
  }

  std::vector<Node> nodes_;
  std::vector<std::int32_t> children_;       ///< ids
  std::vector<std::int32_t> hidden_layers_;  ///< ids
  std::vector<std::int64_t> frames_;
  bool is_sorted_ = false;
};

}  // namespace thimble::tools
