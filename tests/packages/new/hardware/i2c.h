#pragma once

#include <pico/stdlib.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct i2c_inst i2c_inst_t;
extern i2c_inst_t i2c0_inst;
#define i2c0 (&i2c0_inst)

uint i2c_init(i2c_inst_t* i2c, uint baudrate);
int i2c_write_blocking(i2c_inst_t* i2c, uint8_t addr, const uint8_t* src, size_t len, bool nostop);

#ifdef __cplusplus
}
#endif
