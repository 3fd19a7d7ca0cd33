# To be sourced: awk's function three_digits(value), a count as the tables of instructions have it.
three_digits='function three_digits(value, step) {
  for (step = 1; value / step >= 999.5; step *= 10) { }
  return sprintf("%d", int(value / step + 0.5) * step)
}'
