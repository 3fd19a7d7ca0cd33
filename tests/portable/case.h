/// Test cases that run everywhere: on a desktop, in the simulator and on a board of 8 KiB.
///
/// A case is a function that is handed a `Check`: the memory it may use, a few objects that are too large for
/// a small stack, and functions that compare. Everything here is freestanding: no heap, no static variables,
/// no library. tests/boards/apps/cases.cpp runs them.
///
/// Every value that is compared goes into a CRC-32, as 8 bytes whatever its type, so that two machines with
/// one CRC have not only passed the same cases but computed the same numbers. So a case compares nothing
/// whose value depends on the machine (an address, a `sizeof`, SIZE_MAX).
///
/// A case's stack, what it calls included, is to fit in about 1,850 bytes on a Cortex-M0: a ray or a band
/// takes most of that. So no structure of the core is a local variable of a function that traces or draws.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "golden/scenes.h"
#include "thimble/base/memory.h"
#include "thimble/base/status.h"
#include "thimble/base/vec.h"
#include "thimble/picture/camera.h"
#include "thimble/picture/pixel.h"
#include "thimble/picture/shading.h"
#include "thimble/trace/ray.h"

namespace thimble::portable {

#define THIMBLE_TEXT_OF(number) THIMBLE_TEXT_OF_2(number)
#define THIMBLE_TEXT_OF_2(number) #number
/// What a comparison is called: its expression and its line. Where flash is short (THIMBLE_TERSE_CASES) the
/// line alone, which takes no more than the instruction that loads it.
#ifdef THIMBLE_TERSE_CASES
struct What {
  uint32_t line = 0;
};
#define THIMBLE_WHAT(expression) (::thimble::portable::What{__LINE__})
#else
struct What {
  const char* text = nullptr;
};
#define THIMBLE_WHAT(expression) (::thimble::portable::What{expression ", line " THIMBLE_TEXT_OF(__LINE__)})
#endif
/// Of a function that compares several things for a case: which of its calls.
#define THIMBLE_HERE THIMBLE_WHAT("that ray, status or row")

/// The first comparison of a case that failed.
struct Failure {
  What what;
  int64_t got = 0;
  int64_t wanted = 0;
};

class Check {
 public:
  /// A case's memory: exactly as many bytes as it says that it needs, aligned to 8.
  explicit Check(Bytes memory) : arena(memory) {}
  /// Placed by the runner in memory of its own: too large for the stack, and there is no heap.
  static void* operator new(size_t, void* at) { return at; }
  static void operator delete(void*, void*) {}

  /// Where a case takes its memory.
  Arena arena;
  /// `count` of them in the arena, not set to anything; an empty span when they do not fit.
  template <class T>
  Span<T> take(size_t count) {
    static_assert(alignof(T) <= alignof(uint64_t));
    const Bytes bytes = arena.take(count * sizeof(T));
    return {static_cast<T*>(static_cast<void*>(bytes.data)), bytes.size / sizeof(T)};
  }

  /// Objects for a case to use as it likes.
  golden::World world;
  Camera camera;
  Shading shading;
  Hit hit;
  RenderCounts counts;
  TraceOptions options;
  Band band;

  /// Each of these returns whether the comparison held; `what` is the expression and its line. Use them by
  /// the macros below.
  bool that(bool holds, What what) { return equal_32(holds ? 1 : 0, 1, what); }
  template <class Got, class Wanted>
  bool equal(const Got& got, const Wanted& wanted, What what) {
    const Got same = static_cast<Got>(wanted);
    if constexpr (is_small<Got>()) {
      return equal_32(static_cast<int32_t>(got), static_cast<int32_t>(same), what);
    } else if constexpr (sizeof(Got) == 4) {
      return equal_u32(static_cast<uint32_t>(got), static_cast<uint32_t>(same), what);
    } else {
      return equal_64(static_cast<int64_t>(got), static_cast<int64_t>(same), what);
    }
  }
  bool equal(const Vec3i& got, const Vec3i& wanted, What what);
  bool equal(const VoxelBox& got, const VoxelBox& wanted, What what);
  bool equal(const Rgb8& got, const Rgb8& wanted, What what);
  bool equal(Q8 got, Q8 wanted, What what) { return equal_32(got.raw, wanted.raw, what); }
  bool equal(ConstBytes got, ConstBytes wanted, What what);
  bool equal(bool got, bool wanted, What what) { return equal_32(got ? 1 : 0, wanted ? 1 : 0, what); }

  /// Values that nothing is known about but that they are the same everywhere: only the CRC sees them.
  void note(int64_t value);
  void note(const Hit& value);
  void note(const Ray& value);
  void note_bytes(ConstBytes bytes);

  const Failure& failure() const { return failure_; }
  bool failed() const { return failed_; }
  uint32_t crc32() const { return crc_; }

 private:
  /// Whether every value of an enumeration or an integer type is an int32_t.
  template <class T>
  static constexpr bool is_small() {
    if constexpr (__is_enum(T)) {
      return true;
    } else {
      return sizeof(T) < 4 || (sizeof(T) == 4 && static_cast<T>(-1) < T{0});
    }
  }

  // Four arguments of 32 bits are four registers on the small chips, where there are a thousand calls.
  bool equal_32(int32_t got, int32_t wanted, What what);
  bool equal_u32(uint32_t got, uint32_t wanted, What what);
  bool equal_64(int64_t got, int64_t wanted, What what);

  Failure failure_;
  bool failed_ = false;
  uint32_t crc_ = 0;
};

/// These want a `Check& check` in scope. The last two leave the function when they fail.
#define THIMBLE_CHECK(expression) static_cast<void>(check.that((expression), THIMBLE_WHAT(#expression)))
#define THIMBLE_EQUAL(got, wanted) static_cast<void>(check.equal((got), (wanted), THIMBLE_WHAT(#got)))
#define THIMBLE_REQUIRE(expression)                             \
  do {                                                          \
    if (!check.that((expression), THIMBLE_WHAT(#expression))) { \
      return;                                                   \
    }                                                           \
  } while (false)
#define THIMBLE_REQUIRE_OK(status)                                    \
  do {                                                                \
    if (!check.equal((status), Status::kOk, THIMBLE_WHAT(#status))) { \
      return;                                                         \
    }                                                                 \
  } while (false)

/// A case, or several of a table in turn: of `index` and the numbers behind it.
struct Case {
  const char* name;      ///< a statement: what: condition -> result; null where flash is too short for names
  uint32_t arena_bytes;  ///< what `Check::arena` must hold
  void (*run)(Check& check, int index);
  int index = 0;
  const char* detail =
      nullptr;  ///< null, or what tells it from others of this name: of several, what is numbered
  int times = 1;
};

/// The cases of one topic, which stand in one file.
struct Group {
  const char* name;
  const char* file;
  int count;
  Case (*at)(int index);
};

template <const auto& kCases>
constexpr int count_of() {
  int count = 0;
  for (const Case& row : kCases) {
    count += row.times;
  }
  return count;
}
#ifdef THIMBLE_TERSE_CASES
/// A table of cases without their names: as `kCases` itself is then used for nothing else, the linker never
/// sees it.
struct TerseCase {
  void (*run)(Check& check, int index);
  uint16_t arena_bytes;
  uint16_t index_and_times;  // 11 bits and 5
};
template <size_t kCount>
struct TerseTable {
  TerseCase cases[kCount];
};
template <const auto& kCases>
constexpr auto terse() {
  TerseTable<sizeof kCases / sizeof kCases[0]> table{};
  TerseCase* to = table.cases;
  for (const Case& one : kCases) {
    *to++ = {one.run, static_cast<uint16_t>(one.arena_bytes),
             static_cast<uint16_t>(one.index | one.times << 11)};
  }
  return table;
}
template <const auto& kCases>
inline constexpr auto kTerse = terse<kCases>();
/// A group of a plain array of cases.
template <const auto& kCases>
constexpr Group group_of(const char* name, const char* file) {
  return {name, file, count_of<kCases>(), [](int index) -> Case {
            const TerseCase* row = kTerse<kCases>.cases;
            for (; index >= row->index_and_times >> 11; ++row) {
              index -= row->index_and_times >> 11;
            }
            return {nullptr, row->arena_bytes, row->run, (row->index_and_times & 0x7FF) + index};
          }};
}
#else
/// A group of a plain array of cases.
template <const auto& kCases>
constexpr Group group_of(const char* name, const char* file) {
  return {name, file, count_of<kCases>(), [](int index) -> Case {
            const Case* row = kCases;
            for (; index >= row->times; ++row) {
              index -= row->times;
            }
            Case one = *row;
            one.index += index;
            return one;
          }};
}
#endif

/// Marsaglia's 32-bit xorshift (Journal of Statistical Software 8(14), 2003).
struct Random {
  uint32_t state = 0x2545F491U;
  uint32_t next() {
    state ^= state << 13;
    state ^= state >> 17;
    state ^= state << 5;
    return state;
  }
  /// Never two of these in one expression without braces: the order would be the compiler's.
  Vec3i vector(int32_t bound) { return {below(bound), below(bound), below(bound)}; }
  /// 0 .. bound - 1, bound up to 2^16.
  int32_t below(int32_t bound) {
    return static_cast<int32_t>(((next() >> 16) * static_cast<uint32_t>(bound)) >> 16);
  }
};

}  // namespace thimble::portable
