/* What tests/c/face.c, which is C, gives to the tests in C++. */
#pragma once

#ifdef __cplusplus
extern "C" {
#endif

/* Runs the program; 0, or the number of the line that failed. */
int thimble_face_in_c(void);

#ifdef __cplusplus
}
#endif
