#ifndef STUB_ZEPHYR_VERSION_H
#define STUB_ZEPHYR_VERSION_H

#define ZEPHYR_VERSION(a, b, c) (((a) << 16) + ((b) << 8) + (c))
#define ZEPHYR_VERSION_CODE ZEPHYR_VERSION(3, 7, 0)

#endif
