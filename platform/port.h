/// The contract between an application and the place where it runs.
///
/// An application (platform/apps) is one source for every board and for the host simulator. It calls the
/// functions below and the core, and nothing else. A port (platform/boards/NAME with platform/arch/ARCH; on a
/// desktop platform/host; on Linux without a window system platform/linux) defines every one of them but
/// `draw`, `begin_flush`, `await_flush` and what is said of a second core.
///
/// What the port has done before it calls the application: clocks and UART run, the display is on and black,
/// .data and .bss are set up, the stack is painted (`kStackPaint`) and fenced as well as the chip can, and a
/// fault ends with a message on the UART and exit status kFaultStatus.
///
/// What an application does: takes its memory from `arena()`, keeps nothing in static variables, draws bands
/// and flushes them, looks at `running()` once a frame, and returns an exit status.
///
/// None of these functions is called from an interrupt, and none is reentrant; a second core calls those that say so.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "thimble/base/memory.h"
#include "thimble/picture/pixel.h"
#include "thimble/picture/render.h"

namespace thimble::port {

/// The picture that the application draws. A board without a display has the size and format that its
/// pictures have on the UART.
struct Display {
  int32_t width_px;
  int32_t height_px;
  PixelFormat format;
  bool connected;  ///< whether anybody sees what is flushed
};

/// What the board is, from its board.cmake.
struct Facts {
  const char* name;
  uint32_t ram_bytes;
  uint32_t flash_bytes;
  uint32_t stack_bytes;  ///< part of the RAM that is kept for the stack
  Display display;
  /// Node visits that rays through a tree take in a second, everything about a ray included
  /// (BOARD_VISITS_A_SECOND); 0 where an application is not to hold a rate of frames.
  uint32_t visits_a_second = 0;
  /// Rays through a brick map likewise (BOARD_MAP_RAYS_A_SECOND).
  uint32_t map_rays_a_second = 0;
  /// The rate that an application is to hold from its start; 0: it draws exact frames as fast as it can.
  uint32_t hold_fps = 0;
  uint32_t core_mhz = 0;  ///< 0: not known, or another machine's
};
const Facts& facts();

/// All RAM that is not data, bss or stack, aligned to 8 bytes; what it holds at the start is not specified.
Bytes arena();

/// The baked scene in flash (`thimble bake`); empty where none was built in.
ConstBytes scene();

/// Sends rows to the display, in its format and width; `stride_bytes` 0. Every row of a frame is flushed
/// once, in any order of bands. Without a display it does nothing. The bytes may be used again when it
/// returns.
///
/// A band without bytes (`pixels` empty, format, first row and rows as ever) says that these rows are as in
/// the frame before: nothing is sent, and a display shows what it has. Not before a whole frame was flushed.
void flush(const Band& band);

/// Shows the one row of `band`, which is what was flushed last and has not changed, once more: as the row below,
/// `first_row`. A port that copies rows faster within its display than to it has its own (BOARD_FLUSHES_AGAIN).
#if defined(THIMBLE_FLUSHES_AGAIN)
void flush_again(const Band& band);
#else
inline void flush_again(const Band& band) {
  flush(band);
}
#endif

/// The two halves of `flush`: begins to send, and waits until all is sent. From `begin_flush` on the band's
/// bytes are the display's, to be read and not to be written, until `await_flush`, or another `flush` or
/// `begin_flush`, returns: at most one band is on its way. So an application with `band_buffers()` bands of
/// memory, used by turns, never waits by itself. A port that sends while the next band is drawn (DMA) has
/// both, and two bands; any other needs neither: there begin_flush is flush, one band is enough, and the
/// compiler removes the rest. A host, or the page, simulates boards of either kind (THIMBLE_PORT_SIMULATES); the host
/// stops an application that writes too early.
#if defined(THIMBLE_PORT_SIMULATES)
void begin_flush(const Band& band);
void await_flush();
int32_t band_buffers();
#elif defined(THIMBLE_BAND_BUFFERS)
void begin_flush(const Band& band);
void await_flush();
constexpr int32_t band_buffers() {
  return THIMBLE_BAND_BUFFERS;
}
#else
inline void begin_flush(const Band& band) {
  flush(band);
}
constexpr void await_flush() {}
constexpr int32_t band_buffers() {
  return 1;
}
#endif

/// A second core (BOARD_CORES) that draws bands beside this one (apps/band_crew.h). It idles until it is started:
/// `start_core` paints a stack for it, in bytes that stay its own, starts it, and says whether it is there; then
/// `begin_share` has it call `share(argument)`, and `await_share` waits until that has returned. Between the two both
/// cores run; what both touch, `begin_flush` and `await_flush` too, is touched between `lock` and `unlock`. The
/// other functions of this file are for the first core.
/// A port with one core has none of it, and the compiler removes what asks for it. What simulates boards has the
/// number, so that memory is shared out as on the board, and no second core.
#if defined(THIMBLE_CORES)
inline constexpr bool kCanShare = true;
constexpr int32_t cores() {
  return THIMBLE_CORES;
}
bool start_core(const Bytes& stack);
void begin_share(void (*share)(void*), void* argument);
void await_share();
void lock();
void unlock();
#else
inline constexpr bool kCanShare = false;
#if defined(THIMBLE_PORT_SIMULATES)
int32_t cores();
#else
constexpr int32_t cores() {
  return 1;
}
#endif
constexpr bool start_core(const Bytes& /*stack*/) {
  return false;
}
#endif

/// Draws a band of a frame without light in the core's place, with the pixels of `render_band`; false, and
/// the band untouched, where the core is to draw it. Asked for the scene in flash, before the core; the band
/// is then flushed, or written, as it is. Only a host that simulates a board has something faster
/// (simulation.h): there THIMBLE_PORT_DRAWS is defined. A board does not, and its compiler removes the
/// question.
#ifdef THIMBLE_PORT_DRAWS
bool draw(const CompactTree& tree, const Camera& camera, const Shading& shading, const Band& band);
#else
constexpr bool draw(const CompactTree& /*tree*/, const Camera& /*camera*/, const Shading& /*shading*/,
                    const Band& /*band*/) {
  return false;
}
#endif

/// What the hand holds down: buttons of the board, or keys.
enum Button : uint32_t { kUp = 1, kDown = 2, kLeft = 4, kRight = 8, kSelect = 16 };
/// The buttons that are down now, a bit each. 0 where there are none.
uint32_t buttons();

/// The next byte that came over the UART (a terminal's keys), or -1; does not wait.
int read();
/// Sends bytes over the UART; waits until they are taken.
void write(ConstBytes bytes);

/// Whether to draw another frame: false when the user closed the window, or the number of frames that was
/// asked for has been drawn (`frames` = those drawn so far).
bool running(uint32_t frames);
#if defined(THIMBLE_HOLDS)
/// True: an image that waits after its last frame, until a `q` is typed, answers what else is (platform/emulate.sh).
bool holding();
#endif

/// Instructions executed so far, where the place can count them (an emulator with -icount, a counter of the
/// core); modulo 2^32, 0 always where it cannot.
uint32_t instructions();
/// Microseconds since the start, modulo 2^32; 0 always where there is no clock.
uint32_t microseconds();

/// The stack is filled with this byte before the application runs, so that what it used can be seen.
inline constexpr uint8_t kStackPaint = 0xA5;
/// The most bytes of stack that were in use at any time so far, interrupts included.
uint32_t stack_high_water();

/// Exit status after a fault: a bad access, an overflowing stack, a write past the RAM.
inline constexpr int kFaultStatus = 97;

}  // namespace thimble::port
