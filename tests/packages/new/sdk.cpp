// The stand-in for the Pico's SDK. What is not set up as the chip wants it ends the program with status 3.
#include <hardware/i2c.h>
#include <hardware/spi.h>

#include "wires.h"

struct i2c_inst {
  bool is_on;
};
struct spi_inst {
  bool is_on;
};
i2c_inst i2c0_inst;
spi_inst spi1_inst;

namespace {

// What each pin does; D/C and chip select of a Pico-LCD.
gpio_function functions[30];
bool is_output[30];
bool is_pulled_up[30];
bool is_high[30];
constexpr uint kData = 8;
constexpr uint kSelect = 9;

void want(bool holds) {
  if (!holds) {
    exit(3);
  }
}

}  // namespace

void sleep_ms(uint32_t ms) {
  wires::wait(ms);
}
void gpio_init(uint gpio) {
  functions[gpio] = GPIO_FUNC_SIO;
}
void gpio_set_dir(uint gpio, bool out) {
  is_output[gpio] = out;
}
void gpio_put(uint gpio, bool value) {
  want(functions[gpio] == GPIO_FUNC_SIO && is_output[gpio]);
  is_high[gpio] = value;
}
void gpio_pull_up(uint gpio) {
  is_pulled_up[gpio] = true;
}
void gpio_set_function(uint gpio, gpio_function fn) {
  functions[gpio] = fn;
}

uint i2c_init(i2c_inst_t* i2c, uint baudrate) {
  want(baudrate <= 400000);
  i2c->is_on = true;
  return baudrate;
}
int i2c_write_blocking(i2c_inst_t* i2c, uint8_t addr, const uint8_t* src, size_t len, bool nostop) {
  want(i2c->is_on && addr == 0x3C && !nostop);
  want(functions[4] == GPIO_FUNC_I2C && functions[5] == GPIO_FUNC_I2C && is_pulled_up[4] && is_pulled_up[5]);
  wires::tell('i', src, len);
  return static_cast<int>(len);
}

uint spi_init(spi_inst_t* spi, uint baudrate) {
  want(baudrate <= 62500000);
  spi->is_on = true;
  return baudrate;
}
int spi_write_blocking(spi_inst_t* spi, const uint8_t* src, size_t len) {
  want(spi->is_on && functions[10] == GPIO_FUNC_SPI && functions[11] == GPIO_FUNC_SPI && !is_high[kSelect]);
  wires::tell(is_high[kData] ? 'd' : 'c', src, len);
  return static_cast<int>(len);
}
