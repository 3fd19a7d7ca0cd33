// The bytes of a baked scene: opening, checking, writing. src/FORMAT.md is the specification; the offsets
// below are its constants.
#include "thimble/bake/baked_scene.h"

#include "../base/bits.h"
#include "../base/fault.h"
#include "thimble/base/memory.h"

namespace thimble {
namespace {

constexpr uint32_t kSceneMagic = uint32_t{kBakedVersion} << 24 | 0x534D54;  // "TMS", then the version
constexpr uint32_t kSceneMagicMask = 0x00FFFFFF;                            // all but the version
constexpr uint32_t kSceneSizeOffset = 4;
constexpr uint32_t kSceneChecksumOffset = 8;
constexpr uint32_t kSceneCountOffset = 12;
static_assert(kSceneCountOffset + 4 == kBakedHeaderBytes);

// An entry of the list.
constexpr uint32_t kEntryKind = 0;
constexpr uint32_t kEntryOffset = 4;
constexpr uint32_t kEntrySize = 8;
static_assert(kEntrySize + 4 == kBakedEntryBytes);
constexpr uint32_t kAlign = 4;

// The camera's section.
constexpr uint32_t kProjection = 0;
constexpr uint32_t kDirectionBits = 1;
constexpr uint32_t kEye = 4;
constexpr uint32_t kTarget = 16;
constexpr uint32_t kForward = 28;
constexpr uint32_t kUp = 40;
constexpr uint32_t kFov = 52;
constexpr uint32_t kSpan = 56;
constexpr uint32_t kCameraBytes = 60;

constexpr SectionKind kKinds[] = {SectionKind::kTree,     SectionKind::kPalette, SectionKind::kCamera,
                                  SectionKind::kBrickMap, SectionKind::kName,    SectionKind::kLighting,
                                  SectionKind::kLook};

// Those that a reader must know are numbered from 1.
constexpr uint32_t kKindCount = static_cast<uint32_t>(SectionKind::kLighting);

static_assert(sizeof(Rgb8) == 3 && alignof(Rgb8) == 1, "the palette is read where it lies");

constexpr uint64_t aligned(uint64_t bytes, uint32_t to = kAlign) {
  return (bytes + to - 1) & ~uint64_t{to - 1};
}
// A brick map is read in 64-bit words.
constexpr uint32_t alignment_of(SectionKind kind) {
  return kind == SectionKind::kBrickMap ? 8 : kAlign;
}

Vec3i load_vector(const uint8_t* from) {
  Vec3i vector;
  for (int axis = 0; axis < 3; ++axis) {
    vector[axis] = static_cast<int32_t>(bits::load32(from + 4 * axis));
  }
  return vector;
}

void store_vector(uint8_t* to, const Vec3i& vector) {
  for (int axis = 0; axis < 3; ++axis) {
    bits::store32(to + 4 * axis, static_cast<uint32_t>(vector[axis]));
  }
}

Vec3Q8 to_q8(const Vec3i& raw) {
  return {Q8::from_raw(raw.x), Q8::from_raw(raw.y), Q8::from_raw(raw.z)};
}
Vec3i to_raw(const Vec3Q8& point) {
  return {point.x.raw, point.y.raw, point.z.raw};
}

Vec3i forward_of(const SceneCamera& camera) {
  return camera.forward == Vec3i{} ? look_at(camera.eye, camera.target) : camera.forward;
}

// Whether the vectors span a plane: their cross product is not zero. Components up to 2^30, so products
// stay below 2^61.
bool spans(const Vec3i& a, const Vec3i& b) {
  for (int axis = 0; axis < 3; ++axis) {
    const int next = axis == 2 ? 0 : axis + 1;
    const int last = axis == 0 ? 2 : axis - 1;
    if (int64_t{a[next]} * b[last] != int64_t{a[last]} * b[next]) {
      return true;
    }
  }
  return false;
}

bool within(const Vec3i& vector, int32_t low, int32_t high) {
  for (int axis = 0; axis < 3; ++axis) {
    if (vector[axis] < low || vector[axis] > high) {
      return false;
    }
  }
  return true;
}

// Whether a picture could be taken with it, of some size: what `Camera::set` asks of a view.
bool makes_a_view(const SceneCamera& camera, int level) {
  const int bits = camera.direction_bits;
  const Vec3i forward = forward_of(camera);
  if ((bits != 0 && (bits < kMinDirectionBits || bits > kMaxDirectionBits)) ||
      !within(to_raw(camera.eye), kMinOriginWorlds * (Q8::kOne << level),
              kMaxOriginWorlds * (Q8::kOne << level)) ||
      !within(forward, -kMaxViewComponent, kMaxViewComponent) ||
      !within(camera.up, -kMaxViewComponent, kMaxViewComponent) ||
      !spans(forward, camera.up == Vec3i{} ? default_up(forward) : camera.up)) {
    return false;
  }
  return camera.is_perspective ? camera.fov_degrees >= kMinFov && camera.fov_degrees <= kMaxFov
                               : camera.span.raw > 0;
}

SceneCamera load_camera(const uint8_t* from) {
  SceneCamera camera;
  camera.is_perspective = from[kProjection] == 0;
  camera.direction_bits = from[kDirectionBits];
  camera.eye = to_q8(load_vector(from + kEye));
  camera.target = to_q8(load_vector(from + kTarget));
  camera.forward = load_vector(from + kForward);
  camera.up = load_vector(from + kUp);
  camera.fov_degrees = Q16::from_raw(static_cast<int32_t>(bits::load32(from + kFov)));
  camera.span = Q14::from_raw(static_cast<int32_t>(bits::load32(from + kSpan)));
  return camera;
}

void store_camera(uint8_t* to, const SceneCamera& camera) {
  bits::store32(to, 0);
  to[kProjection] = camera.is_perspective ? 0 : 1;
  to[kDirectionBits] = camera.direction_bits;
  store_vector(to + kEye, to_raw(camera.eye));
  store_vector(to + kTarget, to_raw(camera.target));
  store_vector(to + kForward, camera.forward);
  store_vector(to + kUp, camera.up);
  bits::store32(to + kFov, static_cast<uint32_t>(camera.fov_degrees.raw));
  bits::store32(to + kSpan, static_cast<uint32_t>(camera.span.raw));
}

// A part as its section holds it, where it is bytes already; none for the camera.
ConstBytes bytes_of(const BakedParts& parts, SectionKind kind) {
  return kind == SectionKind::kTree       ? parts.tree
         : kind == SectionKind::kBrickMap ? parts.brick_map
         : kind == SectionKind::kName     ? parts.name
         : kind == SectionKind::kLighting ? parts.lighting
         : kind == SectionKind::kLook     ? parts.look
         : kind == SectionKind::kPalette  ? ConstBytes(reinterpret_cast<const uint8_t*>(parts.palette.data),
                                                       sizeof(Rgb8) * parts.palette.size)
                                          : ConstBytes();
}

// Bytes of a part's section; 0 for one that is left out.
size_t section_bytes(const BakedParts& parts, SectionKind kind) {
  return kind != SectionKind::kCamera ? bytes_of(parts, kind).size
         : parts.camera != nullptr    ? kCameraBytes
                                      : 0;
}

void write_section(uint8_t* to, const BakedParts& parts, SectionKind kind) {
  if (kind == SectionKind::kCamera) {
    store_camera(to, *parts.camera);
    return;
  }
  for (const uint8_t byte : bytes_of(parts, kind)) {
    *to++ = byte;
  }
}

}  // namespace

Status set_camera(const SceneCamera& camera, int32_t width_px, int32_t height_px, int level, Camera* result) {
  const auto set = [&](auto& view) {
    view.eye = camera.eye;
    view.forward = forward_of(camera);
    view.up = camera.up;
    view.width_px = width_px;
    view.height_px = height_px;
    view.direction_bits = camera.direction_bits;
    return result->set(view, level);
  };
  if (camera.is_perspective) {
    PerspectiveView view;
    view.fov_degrees = camera.fov_degrees;
    return set(view);
  }
  OrthographicView view;
  view.span = camera.span;
  return set(view);
}

// All that `open` promises; on a fault `*scene` is as it was.
const char* BakedScene::read(ConstBytes bytes, BakedScene* scene, uint32_t* place) {
  if (bytes.size < kBakedHeaderBytes) {
    return fault(place, 0, "shorter than a header");
  }
  const uint8_t* base = bytes.data;
  const uint32_t magic = bits::load32(base);
  if (magic != kSceneMagic) {
    return fault(place, 0,
                 ((magic ^ kSceneMagic) & kSceneMagicMask) == 0 ? kAnotherVersion : "not a baked scene");
  }
  const uint32_t size = bits::load32(base + kSceneSizeOffset);
  const uint32_t count = bits::load32(base + kSceneCountOffset);
  if (size > bytes.size) {
    return fault(place, kSceneSizeOffset, "truncated");
  }
  if (count > kMaxSections || size < kBakedHeaderBytes + kBakedEntryBytes * count) {
    return fault(place, kSceneCountOffset, "a list of sections that does not fit");
  }
  BakedScene result;
  result.bytes_ = {base, size};
  result.crc32_ = bits::load32(base + kSceneChecksumOffset);

  // The sections lie in the order of the list, so none overlaps another.
  uint32_t seen = 0;
  uint32_t camera_at = 0;
  uint32_t end = static_cast<uint32_t>(kBakedHeaderBytes + kBakedEntryBytes * count);
  for (uint32_t index = 0; index < count; ++index) {
    const uint32_t entry = static_cast<uint32_t>(kBakedHeaderBytes + kBakedEntryBytes * index);
    const uint32_t kind = bits::load32(base + entry + kEntryKind);
    const uint32_t offset = bits::load32(base + entry + kEntryOffset);
    const uint32_t length = bits::load32(base + entry + kEntrySize);
    if (offset < end || offset % kAlign != 0 || offset > size || length > size - offset) {
      return fault(place, entry, "a section outside the bytes or on top of another");
    }
    end = offset + length;
    if (kind <= kKindCount) {
      if ((seen >> kind & 1U) != 0) {
        return fault(place, entry, "two sections of one kind");
      }
      seen |= 1U << kind;
    }
    if (kind - 1 >= kKindCount && (kind & kOptionalKind) == 0) {
      return fault(place, entry, kAnotherVersion);
    }
    const ConstBytes content{base + offset, length};
    switch (static_cast<SectionKind>(kind)) {
      case SectionKind::kTree:
        if (CompactTree::open(content, &result.tree_) != Status::kOk || result.tree_.size_bytes() != length) {
          return fault(place, offset, "a damaged tree");
        }
        break;
      case SectionKind::kPalette:
        if (length % sizeof(Rgb8) != 0 || length > sizeof(Rgb8) * kMaxPaletteColors) {
          return fault(place, entry, "a palette of the wrong size");
        }
        result.palette_ = {reinterpret_cast<const Rgb8*>(content.data), length / sizeof(Rgb8)};
        break;
      case SectionKind::kCamera:
        if (length != kCameraBytes || content.data[kProjection] > 1) {
          return fault(place, entry, "a camera of an unknown kind");
        }
        camera_at = offset;
        break;
      case SectionKind::kName:
        if (length > kMaxNameBytes) {
          return fault(place, entry, "a name that is too long");
        }
        break;
      case SectionKind::kBrickMap:
      case SectionKind::kLighting:
      case SectionKind::kLook:
        break;  // whoever uses it opens it
    }
  }
  if (result.tree_.bytes() == nullptr) {
    return fault(place, kSceneCountOffset, "no tree");
  }
  if (camera_at != 0) {
    // Judged by the world, whose section may stand behind the camera's.
    result.camera_ = load_camera(base + camera_at);
    result.has_camera_ = true;
    if (!makes_a_view(result.camera_, result.tree_.level())) {
      return fault(place, camera_at, "a camera that makes no view");
    }
  }
  *scene = result;
  return nullptr;
}

Status BakedScene::open(ConstBytes bytes, BakedScene* scene) {
  return read(bytes, scene, nullptr) == nullptr ? Status::kOk : Status::kDamaged;
}

// Kept apart from `validate`, so that the scene is off the stack when the tree is looked at.
[[gnu::noinline]] const char* BakedScene::check_around(ConstBytes bytes, ConstBytes* tree, uint32_t* place) {
  BakedScene scene;
  if (const char* text = read(bytes, &scene, place)) {
    return text;
  }
  const ConstBytes all = scene.bytes_;
  if (checksum_around(all.data, all.size, kSceneChecksumOffset) != scene.crc32_) {
    return fault(place, kSceneChecksumOffset, "checksum does not match");
  }
  *tree = {scene.tree_.bytes(), scene.tree_.size_bytes()};
  return nullptr;
}

const char* BakedScene::validate(ConstBytes bytes, uint32_t* place) {
  ConstBytes tree;
  const char* text = check_around(bytes, &tree, place);
  return text != nullptr ? text : CompactTree::validate(tree, place);
}

ConstBytes BakedScene::section(SectionKind kind) const {
  const uint32_t count = bytes_.size < kBakedHeaderBytes ? 0 : bits::load32(bytes_.data + kSceneCountOffset);
  for (uint32_t index = 0; index < count && index < kMaxSections; ++index) {
    const uint8_t* entry = bytes_.data + kBakedHeaderBytes + kBakedEntryBytes * index;
    if (bits::load32(entry + kEntryKind) == static_cast<uint32_t>(kind)) {
      return bytes_.subspan(bits::load32(entry + kEntryOffset), bits::load32(entry + kEntrySize));
    }
  }
  return {};
}

size_t baked_bytes(const BakedParts& parts) {
  bool fits = parts.palette.size <= kMaxPaletteColors && parts.name.size <= kMaxNameBytes;
  uint64_t bytes = kBakedHeaderBytes;
  for (const SectionKind kind : kKinds) {
    const size_t length = section_bytes(parts, kind);
    fits = fits && length <= UINT32_MAX;
    bytes += length == 0 ? 0 : kBakedEntryBytes;
  }
  if (!fits) {
    return SIZE_MAX;
  }
  for (const SectionKind kind : kKinds) {
    const size_t length = section_bytes(parts, kind);
    bytes = length == 0 ? bytes : aligned(bytes, alignment_of(kind)) + aligned(length);
  }
  return bytes <= UINT32_MAX && bytes < SIZE_MAX ? static_cast<size_t>(bytes) : SIZE_MAX;
}

Status BakedScene::make(const BakedParts& parts, Bytes to, BakedScene* scene) {
  CompactTree tree;
  const size_t size = baked_bytes(parts);
  if (size == SIZE_MAX || CompactTree::open(parts.tree, &tree) != Status::kOk ||
      tree.size_bytes() != parts.tree.size ||
      (parts.camera != nullptr && !makes_a_view(*parts.camera, tree.level()))) {
    return Status::kBadArgument;
  }
  if (to.size < size) {
    return Status::kOutOfMemory;
  }
  uint32_t count = 0;
  for (const SectionKind kind : kKinds) {
    count += section_bytes(parts, kind) != 0 ? 1U : 0U;
  }
  uint8_t* base = to.data;
  bits::store32(base, kSceneMagic);
  bits::store32(base + kSceneSizeOffset, static_cast<uint32_t>(size));
  bits::store32(base + kSceneCountOffset, count);
  uint8_t* entry = base + kBakedHeaderBytes;
  size_t offset = kBakedHeaderBytes + kBakedEntryBytes * count;
  for (const SectionKind kind : kKinds) {
    const size_t length = section_bytes(parts, kind);
    if (length == 0) {
      continue;
    }
    const size_t start = static_cast<size_t>(aligned(offset, alignment_of(kind)));
    for (; offset < start; ++offset) {
      base[offset] = 0;
    }
    bits::store32(entry + kEntryKind, static_cast<uint32_t>(kind));
    bits::store32(entry + kEntryOffset, static_cast<uint32_t>(offset));
    bits::store32(entry + kEntrySize, static_cast<uint32_t>(length));
    entry += kBakedEntryBytes;
    write_section(base + offset, parts, kind);
    const size_t end = offset + static_cast<size_t>(aligned(length));
    for (offset += length; offset < end; ++offset) {
      base[offset] = 0;
    }
  }
  bits::store32(base + kSceneChecksumOffset, checksum_around(base, size, kSceneChecksumOffset));
  return scene == nullptr ? Status::kOk : open({base, size}, scene);
}

}  // namespace thimble
