// The marks of the handles' kinds. Internal to src/c.
#pragma once

#include "handle.h"

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

// Four letters each, the first 'T'; none is 0.
template <>
inline constexpr uint32_t kMark<BakedScene> = 0x4E435354;  // TSCN
template <>
inline constexpr uint32_t kMark<CompactTree> = 0x45525454;  // TTRE
template <>
inline constexpr uint32_t kMark<Octree> = 0x54434F54;  // TOCT
template <>
inline constexpr uint32_t kMark<Camera> = 0x4D414354;  // TCAM
template <>
inline constexpr uint32_t kMark<BrickMap> = 0x4B524254;  // TBRK
template <>
inline constexpr uint32_t kMark<BakedLighting> = 0x54474C54;  // TLGT
template <>
inline constexpr uint32_t kMark<AnytimeFrame> = 0x4D524654;  // TFRM
template <>
inline constexpr uint32_t kMark<ParticleWorld> = 0x54525054;  // TPRT
template <>
inline constexpr uint32_t kMark<EditedWorld> = 0x444C5754;  // TWLD
template <>
inline constexpr uint32_t kMark<EditJournal> = 0x4E524A54;  // TJRN

}  // namespace c_face
}  // namespace thimble
