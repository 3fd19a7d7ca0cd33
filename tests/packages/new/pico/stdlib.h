// What the projects of `thimble new` call of the Pico's SDK, as it declares it.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef unsigned int uint;
enum gpio_function { GPIO_FUNC_SPI = 1, GPIO_FUNC_I2C = 3, GPIO_FUNC_SIO = 5 };
enum { GPIO_IN = 0, GPIO_OUT = 1 };

void sleep_ms(uint32_t ms);
void gpio_init(uint gpio);
void gpio_set_dir(uint gpio, bool out);
void gpio_put(uint gpio, bool value);
void gpio_pull_up(uint gpio);
void gpio_set_function(uint gpio, enum gpio_function fn);

#ifdef __cplusplus
}
#endif
