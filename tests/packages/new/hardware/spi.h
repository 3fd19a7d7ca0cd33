#pragma once

#include <pico/stdlib.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct spi_inst spi_inst_t;
extern spi_inst_t spi1_inst;
#define spi1 (&spi1_inst)

uint spi_init(spi_inst_t* spi, uint baudrate);
int spi_write_blocking(spi_inst_t* spi, const uint8_t* src, size_t len);

#ifdef __cplusplus
}
#endif
