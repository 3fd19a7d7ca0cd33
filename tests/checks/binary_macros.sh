#!/bin/sh
# The numbers of an Arduino core's binary.h: B0 to B11111111, some of up to eight digits with zeros in front.
awk 'BEGIN {
  for (digits = 1; digits <= 8; ++digits) {
    for (value = 0; value < 2 ^ digits; ++value) {
      name = ""
      for (place = digits - 1; place >= 0; --place) { name = name int(value / 2 ^ place) % 2 }
      print "#define B" name " " value
    }
  }
}'
