/// How changed places of src are switched on: included before everything else in the core that mutate.py writes.
#pragma once

extern "C" {
/// The number of the change that is on; 0 is none.
extern int thimble_mutant;
/// Which places a run came by, a byte each.
extern unsigned char thimble_mutant_reached[];
}

/// Whether change `number` is on; notes that its place was reached.
#define THIMBLE_MUTANT(number) (thimble_mutant_reached[number] = 1, thimble_mutant == (number))
