#ifndef STUB_WIRE_H
#define STUB_WIRE_H

struct TwoWire {};
extern TwoWire Wire;

#endif
