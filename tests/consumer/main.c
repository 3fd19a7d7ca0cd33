/* Runs the program in C of tests/c; the status is the line that failed. */
#include <stdio.h>

#include "c/face.h"

int main(void) {
  const int line = thimble_face_in_c();
  if (line != 0) {
    fprintf(stderr, "face.c:%d failed\n", line);
  }
  return line != 0;
}
