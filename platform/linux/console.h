/// The text console, put aside while pixels are drawn over it, and given back whatever happens.
#pragma once

namespace thimble::linux_port {

/// Switches the console to graphics, so that neither text nor the cursor is drawn over the picture, and its
/// keyboard to silence, so that keys do not reach the shell below. Where there is no console (a file stands
/// in for the screen, or it is a terminal of another kind) it only makes standard input deliver single keys.
/// Restored by `restore_console`, at exit, and on every signal that ends a program.
void take_console();
void restore_console();

/// Whether a signal (interrupt, hang-up, terminate) asked for the end.
bool asked_to_end();

}  // namespace thimble::linux_port
