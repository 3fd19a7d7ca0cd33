// What a handle of the C face holds: a mark that tells it from bytes that hold nothing and from handles of other kinds,
// and an object of the core. Internal to src/c.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "thimble/base/memory.h"
#include "thimble/base/status.h"
#include "thimble/base/vec.h"
#include "thimble/thimble_c.h"

// The functions of thimble_c.h stand in namespace c_face here; `extern "C"` makes them the same ones, but gcc looks for
// a declaration in that namespace.
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wmissing-declarations"
#endif

namespace thimble {

class AnytimeFrame;
class BakedScene;
struct BakedLighting;
class BrickMap;
class Camera;
class CompactTree;
class EditJournal;
class EditedWorld;
class Octree;
class ParticleWorld;

namespace c_face {

/// Which kind of object: what a handle's first word says, four letters each. A handle of another kind holds nothing.
struct Marks {
  static constexpr uint32_t of(const BakedScene*) { return 0x4E435354; }     // TSCN
  static constexpr uint32_t of(const CompactTree*) { return 0x45525454; }    // TTRE
  static constexpr uint32_t of(const Octree*) { return 0x54434F54; }         // TOCT
  static constexpr uint32_t of(const Camera*) { return 0x4D414354; }         // TCAM
  static constexpr uint32_t of(const BrickMap*) { return 0x4B524254; }       // TBRK
  static constexpr uint32_t of(const BakedLighting*) { return 0x54474C54; }  // TLGT
  static constexpr uint32_t of(const AnytimeFrame*) { return 0x4D524654; }   // TFRM
  static constexpr uint32_t of(const ParticleWorld*) { return 0x54525054; }  // TPRT
  static constexpr uint32_t of(const EditedWorld*) { return 0x444C5754; }    // TWLD
  static constexpr uint32_t of(const EditJournal*) { return 0x4E524A54; }    // TJRN
};
template <class Object>
inline constexpr uint32_t kMark = Marks::of(static_cast<const Object*>(nullptr));

template <class Object>
struct Held {
  uint32_t mark;
  Object object;
};

template <class Object, class Handle>
constexpr bool fits() {
  static_assert(__is_trivially_copyable(Object), "C copies handles as bytes");
  static_assert(sizeof(Held<Object>) <= sizeof(Handle),
                "enum thimble_sizes has too few words for this handle");
  static_assert(alignof(Held<Object>) <= alignof(Handle));
  return true;
}

/// Whether a handle can be looked at: not null, and where C would have put it.
template <class Handle>
bool stands(const Handle* handle) {
  return handle != nullptr && (reinterpret_cast<uintptr_t>(handle) & (alignof(Handle) - 1)) == 0;
}

/// The object that a handle holds; null when it holds none, or one of another kind.
template <class Object, class Handle>
Object* held(Handle* handle) {
  static_assert(fits<Object, Handle>());
  if (!stands(handle)) {
    return nullptr;
  }
  Held<Object>* const here = reinterpret_cast<Held<Object>*>(handle);
  return here->mark == kMark<Object> ? &here->object : nullptr;
}
template <class Object, class Handle>
const Object* held(const Handle* handle) {
  return held<Object>(const_cast<Handle*>(handle));
}

/// `status`; on kOk the handle holds a copy of `object`, otherwise it is as it was.
template <class Object, class Handle>
int32_t hold(Status status, const Object& object, Handle* handle) {
  static_assert(fits<Object, Handle>());
  if (status == Status::kOk) {
    Held<Object>* const here = reinterpret_cast<Held<Object>*>(handle);
    // As bytes, which makes an object of them.
    __builtin_memcpy(&here->object, &object, sizeof object);
    here->mark = kMark<Object>;
  }
  return static_cast<int32_t>(status);
}

constexpr int32_t number(Status status) {
  return static_cast<int32_t>(status);
}

/// What `call(object)` says of the object that a handle holds; kBadArgument where it holds none.
template <class Object, class Handle, class Call>
int32_t with(Handle* handle, const Call& call) {
  auto* const object = held<Object>(handle);
  return number(object == nullptr ? Status::kBadArgument : call(*object));
}

/// Has `say(object)` fill `to`, which may not be null, from the object that a handle holds.
template <class Object, class Handle, class To, class Say>
int32_t tell(const Handle* handle, const To* to, const Say& say) {
  return with<Object>(handle, [&](const Object& object) {
    if (to == nullptr) {
      return Status::kBadArgument;
    }
    say(object);
    return Status::kOk;
  });
}

/// Bytes as C gives them. False for a null pointer with a size.
template <class Byte, class Void>
bool take_bytes(Void* bytes, size_t size, Span<Byte>* span) {
  *span = {static_cast<Byte*>(bytes), size};
  return bytes != nullptr || size == 0;
}

/// Lets a handle hold what `make(bytes, &object)` makes in bytes as C gives them.
template <class Object, class Byte = uint8_t, class Handle, class Void, class Make>
int32_t make_held(Handle* handle, Void* bytes, size_t size, const Make& make) {
  Span<Byte> memory;
  if (!stands(handle) || !take_bytes(bytes, size, &memory)) {
    return number(Status::kBadArgument);
  }
  Object made;
  const Status status = make(memory, &made);
  return hold(status, made, handle);
}

constexpr Vec3i vector_of(const thimble_vec3_t& from) {
  return {from.x, from.y, from.z};
}
constexpr Vec3Q8 point_of(const thimble_vec3_t& from) {
  return {Q8::from_raw(from.x), Q8::from_raw(from.y), Q8::from_raw(from.z)};
}
constexpr thimble_vec3_t to_c(const Vec3i& from) {
  return {from.x, from.y, from.z};
}
constexpr thimble_vec3_t to_c(const Vec3Q8& from) {
  return {from.x.raw, from.y.raw, from.z.raw};
}
constexpr thimble_box_t to_c(const VoxelBox& from) {
  return {to_c(from.low), to_c(from.high)};
}

}  // namespace c_face
}  // namespace thimble
