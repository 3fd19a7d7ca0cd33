/// @file status.h
/// How every operation of the core that can fail says so. There are no exceptions.
#ifndef THIMBLE_BASE_STATUS_H
#define THIMBLE_BASE_STATUS_H

#if defined(__AVR__)
#error "AVR is not supported: int has 16 bits. Thimble needs a chip of 32 bits."
#elif defined(__SIZEOF_INT__) && __SIZEOF_INT__ < 4
#error "This processor is not supported: int has 16 bits. Thimble needs one of 32 bits."
#endif

#include <stdint.h>

namespace thimble {

/// The outcome of an operation. Unless a function says otherwise, anything but `kOk` means that nothing has
/// changed.
enum class [[nodiscard]] Status : uint8_t{
    kOk = 0,
    kOutOfMemory,  ///< the bytes given do not hold the result
    kOutOfRange,   ///< a coordinate, a direction or a size lies beyond a stated limit
    kBadArgument,  ///< an argument contradicts itself (zero direction, up parallel to the view, no pixels)
    kTooFine,      ///< a picture so fine that its rays could not be kept within 1/8 pixel
    kDamaged,      ///< bytes that are not what they should be, or of another version
    kStepLimit,    ///< a ray was stopped by the step limit before its answer was known
};

/// A short English phrase for `status`, for example "out of memory". Never null.
constexpr const char* status_text(Status status) {
  switch (status) {
    case Status::kOk:
      return "ok";
    case Status::kOutOfMemory:
      return "out of memory";
    case Status::kOutOfRange:
      return "out of range";
    case Status::kBadArgument:
      return "bad argument";
    case Status::kTooFine:
      return "picture too fine for the ray's precision";
    case Status::kDamaged:
      return "damaged tree";
    case Status::kStepLimit:
      return "step limit reached";
  }
  return "unknown status";
}

/// What `validate` says of bytes that are sound as far as it knows, but were written by a version of this
/// library whose format it does not read. `open` says kDamaged, as of any bytes that it cannot use.
inline constexpr char kAnotherVersion[] = "made by another version of thimble: bake it again";

}  // namespace thimble

#endif
