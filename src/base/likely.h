/// @file likely.h
/// Where the compiler lays out the code that runs seldom.
#ifndef THIMBLE_SRC_BASE_LIKELY_H
#define THIMBLE_SRC_BASE_LIKELY_H

/// `THIMBLE_UNLIKELY;` begins a block that is seldom entered: C++20's [[unlikely]], which gcc also takes in
/// C++17; nothing elsewhere.
#if defined(__clang__) && __cplusplus < 202002L
#define THIMBLE_UNLIKELY
#else
#define THIMBLE_UNLIKELY [[unlikely]]
#endif

#endif
