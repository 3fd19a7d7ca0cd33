// The marks of the handles' kinds. Internal to src/c.
#ifndef THIMBLE_SRC_C_KINDS_H
#define THIMBLE_SRC_C_KINDS_H

#include "handle.h"

namespace thimble {

class AnytimeFrame;
class BakedScene;
struct BakedLighting;
class BrickMap;
class Camera;
class CompactTree;
class Octree;
class ParticleWorld;

namespace c_face {

// Four letters each, the first 'T'; none is 0.
template <>
struct Kind<BakedScene> {
  static constexpr uint32_t kMark = 0x4E435354;  // TSCN
};
template <>
struct Kind<CompactTree> {
  static constexpr uint32_t kMark = 0x45525454;  // TTRE
};
template <>
struct Kind<Octree> {
  static constexpr uint32_t kMark = 0x54434F54;  // TOCT
};
template <>
struct Kind<Camera> {
  static constexpr uint32_t kMark = 0x4D414354;  // TCAM
};
template <>
struct Kind<BrickMap> {
  static constexpr uint32_t kMark = 0x4B524254;  // TBRK
};
template <>
struct Kind<BakedLighting> {
  static constexpr uint32_t kMark = 0x54474C54;  // TLGT
};
template <>
struct Kind<AnytimeFrame> {
  static constexpr uint32_t kMark = 0x4D524654;  // TFRM
};
template <>
struct Kind<ParticleWorld> {
  static constexpr uint32_t kMark = 0x54525054;  // TPRT
};

}  // namespace c_face
}  // namespace thimble

#endif
