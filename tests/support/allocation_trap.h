/// Counts the calls of the global allocator (`operator new` and `operator delete`) between two points.
///
/// That the core's objects do not know `malloc` either is read off their symbols elsewhere. One thread at a
/// time.
#pragma once

namespace thimble::tests {

/// Counts from 0 from here on.
void set_allocation_trap();
/// Stops counting and returns the calls since.
int clear_allocation_trap();

}  // namespace thimble::tests
