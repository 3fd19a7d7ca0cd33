/// The applications: each is one source, platform/apps/NAME.cpp, for every board and for the host simulator; those that test
/// a board stand in tests/boards/apps.
///
/// They return an exit status: 0 when all went well. In a firmware image the build picks one
/// (`make firmware BOARD=... APP=NAME`) and the linker leaves the others out.
#pragma once

namespace thimble::apps {

/// The baked scene turns; buttons move the camera. Keys over the UART: `p` sends the picture as P5, `b`
/// builds a scene of spheres on the chip itself, `q` ends.
int demo();
/// The core's own test cases on the target; closes with `N passed, N failed`.
int selftest();
/// Baked scenes and the golden frames on the target; closes in the same way. An application of its own,
/// because both together do not fit in 128 KiB of flash.
int golden();
/// Lit pictures on the target, likewise.
int lit();
/// Worlds of other shapes (edited, as bricks, shared) and the plane on the target, likewise.
int worlds();
/// Frames by bricks on the target, likewise.
int bricks();
/// Lit frames by bricks on the target, likewise.
int map_light();
/// The pixel formats of panels on the target, in an image that has them all; likewise.
int formats();
/// Instructions a frame and a ray, nodes visited, RAM and stack used.
int bench();
/// The paper's particle world.
int particles();
/// A lit scene whose water moves: touched, and by what falls in. Draws only what can have changed.
int water();
/// The scene in RAM, where voxels are dug away and put: picking, and a world that changes.
int dig();
/// Overflows the stack, writes past the RAM and the like when a key asks for it; only on a board.
int faults();

}  // namespace thimble::apps
